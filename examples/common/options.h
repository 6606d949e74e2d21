/* options.h: the command line of a program: a table of options -> the program's own variables. */
#ifndef RIDDLE_OPTIONS_H
#define RIDDLE_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    OPTION_FLAG,
    OPTION_INT,
    OPTION_SEED,
    OPTION_DOUBLE,
    OPTION_STRING,
    OPTION_CHOICE,
    OPTION_SIZE
} option_kind;

/* One option. Made by the functions below; `value` points to the caller's variable, which holds the default before and
   the answer after. */
typedef struct option {
    const char *name;    /* without the dashes */
    const char *metavar; /* what --help calls the value; NULL for a flag */
    option_kind kind;
    void *value;
    double low, high;    /* allowed, both ends included; infinite: no bound */
    bool above;          /* low itself is not allowed */
    const char *choices; /* "linear|hertz" */
    const char *help;    /* one sentence with the unit in brackets */
    bool given;          /* out: stood on the command line */
} option;

option option_flag(const char *name, bool *value, const char *help);
option option_int(const char *name, const char *metavar, int *value, int low, int high, const char *help);
option option_seed(const char *name, const char *metavar, uint64_t *value, const char *help); /* 0 .. 2^64-1 */
option option_double(const char *name, const char *metavar, double *value, double low, double high, const char *help);
/* 0 < value <= high */
option option_positive(const char *name, const char *metavar, double *value, double high, const char *help);
option option_string(const char *name, const char *metavar, const char **value, const char *help);
/* value: index into "first|second|third" */
option option_choice(const char *name, int *value, const char *choices, const char *help);
/* Of a picture, WxH, such as 1920x1280: 64 .. 4096 pixels each. */
option option_size(const char *name, int size[2], const char *help);

/* What every program has. Strings live as long as argv. */
typedef struct program {
    const char *name;
    const char *out;  /* folder that exists and can be written to; default out/<name> */
    const char *json; /* file for the one JSON object, or NULL */
    int threads;      /* default: number of cores */
    uint64_t seed;    /* default 1 */
    bool quiet, quick, version;
    double started; /* machine_seconds() at the start */
    const option *options;
    int option_count;
} program;

/* Reads the command line. Prints the help or the version and leaves with 0, or one line naming option, value and what
   is allowed and leaves with 2 (also if the --out folder cannot be made or written to). Installs the Ctrl-C handler of
   progress.h. about: one or more sentences for --help. options may be NULL with n 0. */
program program_start(const char *name, const char *about, option *options, int n, int argc, char **argv);

/* Was the option --name on the command line? A name that the program has not ends it: the program is wrong. */
bool is_given(const program *self, const char *name);

/* What --help says of the defaults of --out and --seed where a program has others; NULL: as above. Before
   program_start. */
void program_say_defaults(const char *out, const char *seed);

/* The same without leaving: 0 fine, 1 help asked for, 2 bad input with one line in message. Touches no file. For tests
   and for hosts with their own main. */
int options_parse(program *self, option *options, int n, int argc, char **argv, char *message, int message_size);

/* The seed of run `index` of those that a program makes under --seed: mixed, so that runs under seeds that follow each
   other share none. */
uint64_t program_seed_of(uint64_t seed, uint64_t index);

/* Says that an option's value is bad for a reason that only the program knows, and leaves with 2:
   "batch_screening: --case 4: not with --amplitude-mm". value may be NULL. */
void program_refuse(const program *self, const char *option_name, const char *value, const char *allowed);

/* Leaves with 2 and one line that names the option if what it asks for takes more memory [B] than is free; else
   does nothing. */
void program_need_memory(const program *self, const char *option_name, double bytes);
void program_need_spheres(const program *self, const char *option_name, double spheres); /* of dem.h, held at a time */

#endif
