/* sheet_words.h: the words of headings, in small letters, umlauts as ae, oe, ue, ss. To be included by sheet.c and
   sheet_sizes.c only. */
#ifndef RIDDLE_SHEET_WORDS_H
#define RIDDLE_SHEET_WORDS_H

#include <stddef.h>

#include "sheet.h"

/* ---- columns by name: other names of it; _ joins the words of one ---- */

typedef struct sheet_name {
    const char *name, *words;
} sheet_name;
static const sheet_name sheet_names[] = {
    {"time", "time zeit dauer t filtrationszeit siebzeit elapsed_time duration"},
    {"volume", "volume volumen filtratvolumen filtrate filtrat v filtrate_volume vf"},
    {"mass", "mass masse gewicht weight filtratmasse m filtrate filtrat filtrate_mass balance waage"},
    {"pressure", "pressure druck druckdifferenz differenzdruck pressure_difference pressure_drop delta_p p dp"},
    {"case", "case fall versuch test run"},
    {"test", "test versuch case fall run"},
    {"size", "size sizes korngroesse korn groesse grain_size particle_size diameter durchmesser d x"},
    {"retained", "retained rueckstand siebrueckstand"},
    {"amplitude", "amplitude schwingweite"},
    {"frequency", "frequency frequenz drehzahl speed"},
    {"aperture", "aperture opening maschenweite oeffnung lochweite siebweite"},
    {"moisture", "moisture feuchte feuchtigkeit wassergehalt water_content"},
    {"wire", "wire draht drahtdurchmesser drahtdicke wire_diameter"},
    {"inclination", "inclination neigung slope"},
    {"load", "load beladung flaechenlast"},
    {"share", "share anteil massenanteil mass_share mass_fraction"},
    {"oversize", "oversize ueberkorn"},
    {"low", "low lower von from untere_grenze min"},
    {"high", "high upper bis to obere_grenze max"},
    {"contacts", "contacts kontakte stoesse"},
    {"t", "t tromp separation trenngrad partition"},
    {"K", "k"},
    {"x_h", "x_h xh"},
    {"holes", "holes loecher maschen"},
    {"free_holes", "free_holes freie_loecher offene_loecher freie_maschen offene_maschen"},
    {"free_fraction", "free_fraction freier_anteil offener_anteil"},
    {"feed", "feed aufgabe aufgabegut"},
    {"coarse", "coarse grobgut grob underflow"},
    {"fine", "fine fines feingut fein overflow"},
};

/* Words beside a name that do not change what it names. */
static const char sheet_harmless[] = " the of in der des die das measured gemessen gemessene gemessener ";

/* ---- sizes and amounts of sieves ---- */

enum {
    WORD_SIEVE = 1 << 0,
    WORD_SIZE = 1 << 1,
    WORD_GRAIN = 1 << 2,
    WORD_LOW = 1 << 3,
    WORD_HIGH = 1 << 4,
    WORD_CLASS = 1 << 5,
    WORD_PHI = 1 << 6,
    WORD_MESH = 1 << 7,
    WORD_ASTM = 1 << 8,
    WORD_TYLER = 1 << 9,
    WORD_FINER = 1 << 10,
    WORD_COARSER = 1 << 11,
    WORD_RETAINED = 1 << 12,
    WORD_CUM = 1 << 13,
    WORD_SHARE = 1 << 14,
    WORD_MASS = 1 << 15,
    WORD_SOIL = 1 << 16,
    WORD_TARE = 1 << 17,
    WORD_GROSS = 1 << 18,
    WORD_NET = 1 << 19,
    WORD_PERCENT = 1 << 20,
    WORD_NUMBER = 1 << 21,
    WORD_FRACTION = 1 << 22,
    WORD_VOLUME = 1 << 23,
    WORD_NOTHING = 1 << 24,
    WORD_UNKNOWN = 1 << 25
};

typedef struct sheet_word {
    unsigned bit;
    const char *words; /* each between blanks */
} sheet_word;
static const sheet_word sheet_sieve_words[] = {
    {WORD_SIEVE, " sieve sieves sieb siebe tamis screen "},
    {WORD_SIZE, " size sizes opening openings aperture apertures diameter diameters dia width weite groesse siebweite "
                "maschenweite korngroesse "
                "korndurchmesser siebgroesse lochweite durchmesser maschengroesse nennweite siebnennweite oeffnung "
                "siebmaschenweite "
                "partikelgroesse partikeldurchmesser d x w dp "},
    {WORD_GRAIN, " grain grains particle particles korn koerner partikel equivalent aequivalent nominal limit limits "
                 "grenze klassengrenze "
                 "boundary edge korngrenze "},
    {WORD_LOW, " low lower from von untere unterer min minimum "},
    {WORD_HIGH, " high upper to bis obere oberer max maximum "},
    {WORD_CLASS,
     " class classes interval range klasse kornklasse kornfraktion bereich bin korngroessenklasse siebklasse "},
    {WORD_FRACTION, " fraction fractions fraktion "},
    {WORD_PHI, " phi "},
    {WORD_MESH, " mesh meshes "},
    {WORD_ASTM, " astm us std standard e11 no nr "}, /* sieves with a "No." are those of ASTM */
    {WORD_TYLER, " tyler "},
    {WORD_FINER, " passing passed finer undersize durchgang siebdurchgang durchgangssumme durchgaenge less below "
                 "smaller than kleiner "
                 "unterkorn cpft tamisat passant "},
    {WORD_COARSER, " coarser oversize larger above greater rueckstandssumme rueckstandsumme siebrueckstandssumme r "
                   "groesser ueberkorn "},
    {WORD_RETAINED, " retained rueckstand siebrueckstand on auf residue refus retaining "},
    {WORD_CUM, " cumulative cumulated cum cumul accumulated kumuliert kumulierter kumulierte kumulativ summe summen "
               "sum kum summiert "},
    {WORD_SHARE, " share shares anteil anteile massenanteil masseanteil gewichtsanteil mengenanteil volumenanteil "
                 "frequency haeufigkeit "
                 "proportion q3 q0 "},
    {WORD_MASS, " mass masse weight gewicht auswaage m siebgewicht "},
    {WORD_VOLUME, " volume volumen vol volumenanteil "},
    {WORD_SOIL, " soil sample probe material gut siebgut probenmasse "},
    {WORD_TARE, " empty tare tara leer leergewicht leermasse siebgewicht "},
    {WORD_GROSS, " gross brutto bruttomasse "},
    {WORD_NET, " net netto nettomasse "},
    {WORD_PERCENT, " percent percentage prozent pct perc "},
    {WORD_NUMBER, " number anzahl zahl nummer "},
    {WORD_NOTHING, " the of in by a an at der des die das dem den im am mean measured gemessen each per je individual "
                   "einzeln test wt total "},
};

static const char sheet_pan_words[] =
    " pan boden bodenpfanne siebboden auffangschale auffang schale receiver bottom fond bodensatz pfanne ";
static const char sheet_total_words[] = " total sum summe gesamt gesamtsumme totals insgesamt somme ";

/* Nominal widths of sieves [mm]: ASTM E11 (also ISO 3310-1), Tyler. */
typedef struct sheet_mesh {
    double number, width;
} sheet_mesh;
static const sheet_mesh sheet_astm[] = {
    {3.5, 5.6},   {4, 4.75},    {5, 4.0},     {6, 3.35},    {7, 2.8},     {8, 2.36},    {10, 2.0},
    {12, 1.7},    {14, 1.4},    {16, 1.18},   {18, 1.0},    {20, 0.85},   {25, 0.71},   {30, 0.6},
    {35, 0.5},    {40, 0.425},  {45, 0.355},  {50, 0.3},    {60, 0.25},   {70, 0.212},  {80, 0.18},
    {100, 0.15},  {120, 0.125}, {140, 0.106}, {170, 0.09},  {200, 0.075}, {230, 0.063}, {270, 0.053},
    {325, 0.045}, {400, 0.038}, {450, 0.032}, {500, 0.025}, {635, 0.02}};
static const sheet_mesh sheet_tyler[] = {
    {3.5, 5.6},  {4, 4.75},    {5, 4.0},     {6, 3.35},    {7, 2.8},     {8, 2.36},    {9, 2.0},     {10, 1.7},
    {12, 1.4},   {14, 1.18},   {16, 1.0},    {20, 0.85},   {24, 0.71},   {28, 0.6},    {32, 0.5},    {35, 0.425},
    {42, 0.355}, {48, 0.3},    {60, 0.25},   {65, 0.212},  {80, 0.18},   {100, 0.15},  {115, 0.125}, {150, 0.106},
    {170, 0.09}, {200, 0.075}, {250, 0.063}, {270, 0.053}, {325, 0.045}, {400, 0.038}, {500, 0.025}};

/* ---- shared by the two files ---- */

typedef struct sheet_heading {
    char words[8][40]; /* in small letters */
    int n;
    bool percent;
    char dimension; /* 0: no unit */
    double si;
} sheet_heading;

/* Marks of numbers in a table. */
typedef struct sheet_marks {
    char decimal; /* '.', ',', or 0: both are used, never in doubt */
    bool grouped; /* the other mark separates thousands */
    /* A number with three decimals, where none of the table shows that the mark is not one of thousands; else "". */
    char doubtful[16];
} sheet_marks;
enum { SHEET_MARKS = 160 };

/* A text cut into cells, before anybody knows where its heading is. */
typedef struct sheet_text {
    int rows;
    char separator;
    const char **cell; /* [first[rows]], cells of row r from first[r] */
    int *first, *line; /* [rows + 1], [rows] */
    void *memory[4];
} sheet_text;

const char *sheet_words_of(const char *name); /* the other names of a column */
void sheet_fold(const char *text, char *out, size_t size);
void sheet_read_heading(const char *text, sheet_heading *h);
bool sheet_is_word(const char *words, const char *word); /* between blanks */
int sheet_cut(const char *bytes, long size, const char *path, sheet_text *out, char *message, int message_size);
void sheet_text_free(sheet_text *t);
/* Lines that a heading in this row may have: 1; 2: the row below has no numbers; 3: the row below has the units. */
int sheet_heading_lines(const sheet_text *t, int row);
/* Headings of a row, joined with the row below where lines is 2 or 3; returns their number. */
int sheet_headings(const sheet_text *t, int row, int lines, const char **names, char *room, size_t size);
bool sheet_is_total(const sheet_text *t, int row);
/* The marks of all numbers in these columns below a row; -1: in doubt. */
int sheet_find_marks(const sheet_text *t, int from, const int *column, int n, const char *path, sheet_marks *marks,
                     char *message, int message_size);
/* A number at the beginning of a text; *end: behind it. */
bool sheet_scan(const char *text, const sheet_marks *marks, double *value, const char **end);
/* A unit behind a number: 0 none, 1 read; -1 something else. */
int sheet_unit(const char *text, char *dimension, double *si);
int sheet_refuse(char *message, int size, const char *format, ...);
/* "path: what name; the columns are ..." */
int sheet_refuse_columns(char *message, int size, const char *path, const char *what, const char *name,
                         const char *const *names, int n);
/* "decimal commas, ", with what is in doubt. */
const char *sheet_marks_text(const sheet_text *t, const sheet_marks *marks, char text[SHEET_MARKS]);

#endif
