/* The command line: any words give values within what the table allows, or one line; the input is cut into words
   at newlines. */
#include "fuzz.h"

#include <math.h>

#include "options.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static char program_name[] = "prog";
    char text[2001], *argv[64] = {program_name}, message[160] = "";
    int argc = 1, run = 5, law = 0;
    double time = 5.0, angle = 0.0;
    bool flag = false;
    const char *path = "default";
    uint64_t other = 1;
    if (size > sizeof text - 1) size = sizeof text - 1;
    if (size) memcpy(text, bytes, size);
    text[size] = '\0';
    for (char *at = text; argc < 63; at++) {
        argv[argc++] = at;
        at += strcspn(at, "\n");
        if (!*at) break;
        *at = '\0';
    }
    option options[] = {
        option_int("case", "N", &run, 1, 15, "case"),
        option_positive("time", "S", &time, 1e4, "time [s]"),
        option_double("angle", "DEG", &angle, -90.0, 90.0, "angle [deg]"),
        option_flag("wet", &flag, "with liquid"),
        option_choice("law", &law, "linear|hertz", "law"),
        option_string("input", "FILE", &path, "file"),
        option_seed("other", "N", &other, "seed"),
    };
    program self = {"prog", "out/prog", NULL, 2, 1, false, false, false, 0.0, NULL, 0};
    int status = options_parse(&self, options, 7, argc, argv, message, (int)sizeof message);
    FUZZ_ASSERT(status >= 0 && status <= 2);
    FUZZ_ASSERT((status == 2) == (message[0] != '\0') && !strchr(message, '\n') && strlen(message) < sizeof message);
    FUZZ_ASSERT(run >= 1 && run <= 15 && time > 0.0 && time <= 1e4 && fabs(angle) <= 90.0 && law >= 0 && law <= 1 &&
                *path && *self.out);
    FUZZ_ASSERT(self.threads >= 1 && self.threads <= 4096);
    return 0;
}

static const char *const samples[] = {
    "--case\n3\n--time=0.5\n--angle\n-45",
    "--wet\n--law\nhertz\n--input\nfile.csv",
    "--threads\n4\n--seed\n18446744073709551615\n--quiet\n--quick",
    "--out\ndir\n--json\n-\n--help",
    "--tiem\n3",
    "--time\nnan\n--angle=1e999\n--case=0x10",
    "--other=-1",
    "--=\n-\n--\n-h",
};

FUZZ_MAIN(samples, 8, 200000)
