/* The reader of laboratory tables: any bytes give a curve that rises, a table of numbers, or one line. */
#include "fuzz.h"

#include "sheet.h"

static void check_curve(const uint8_t *bytes, size_t size, const char *const *names, int n) {
    char message[160] = "";
    sheet_sizes s;
    if (sheet_parse_sizes((const char *)bytes, (long)size, "input", names, n, &s, message, (int)sizeof message) != 0) {
        FUZZ_ASSERT(message[0] && !s.memory && s.n == 0 && !strchr(message, '\n'));
        return;
    }
    FUZZ_ASSERT(s.n > 0 && !message[0] && s.how[0] && s.size[0] > 0.0);
    for (int k = 1; k < s.n; k++) FUZZ_ASSERT(s.size[k] > s.size[k - 1]);
    for (int j = 0; j < n && !s.single; j++)
        for (int k = 0; k < s.n && s.amount[j] && j != 3; k++) {
            FUZZ_ASSERT(s.amount[j][k] >= -1e-9 && s.amount[j][k] <= 1.001);
            FUZZ_ASSERT(k == 0 || s.amount[j][k] >= s.amount[j][k - 1] - 1e-9);
        }
    sheet_free_sizes(&s);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static const char *const names[4] = {"feed", "coarse", "fine", "feed_sd"};
    sheet_column c[3] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', true),
                         sheet_want("share", '%', false)};
    char message[160] = "";
    sheet s;
    check_curve(bytes, size, NULL, 1);
    check_curve(bytes, size, names, 4);
    if (sheet_parse((const char *)bytes, (long)size, "input", c, 3, &s, message, (int)sizeof message) != 0) {
        FUZZ_ASSERT(message[0] && !s.cell && s.rows == 0 && !strchr(message, '\n'));
        return 0;
    }
    FUZZ_ASSERT(s.rows > 0 && !message[0] && s.how[0] && c[0].value && c[1].value);
    for (int k = 0; k < s.rows * s.columns; k++) FUZZ_ASSERT(s.cell[k]);
    sheet_free(&s);
    return 0;
}

static const char *const samples[] = {
    ("sep=;\r\nSiebweite in mm;R\xc3\xbc"
     "ckstand in g;;\r\n16;0,0;;\r\n8;25,0;;\r\nBoden;25,0;;\r\nSumme;250,0;;\r\n"),
    "# comment\nSieve (in),mass %\n1 1/2,20\n3/8\",30\n<63 um,50\n",
    "Klasse [um];Aufgabe [%];Grobgut [%];Feingut [%];Aufgabe sd\n< 2;10,0;2,0;18,0;1\n2 - 4;90,0;98,0;82,0;2\n",
    "low,high,share\n,10,20 %\n10,20,80 %\n",
    "time [s]\tvolume [ml]\tshare\n0\t1.250,5\t10\n1e1\t2 000\t20\n",
    "Zeit;Volumen\ns;ml\n0;0\n90;1250,5\n",
    "\"Sieve\nopening [mm]\",\"Cum. % retained\"\n-125+63,10\n4,30\nPan,100\n",
    "phi;weight\n-1,5;20 g\n2;30 g\n",
    "No.,Tyler mesh,sieve mass,sieve soil mass\n4,4,750,812.4\nPan,,450,501\n",
    "\xff\xfes\0i\0z\0e\0",
};

FUZZ_MAIN(samples, 10, 20000)
