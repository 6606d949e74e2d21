/* Every example and benchmark as its user meets it: help, version, wrong options and input files, a quick run with its
   files, too little memory, standard streams that are closed, a device and a disk that are full, signals.
   The programs' paths stand in RIDDLE_PROGRAMS, one a line (meson.build sets it); none: nothing to test. */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <ctype.h>
#include <fcntl.h>
#include <ftw.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

enum { LONGEST_PATH = 500, MOST_PROGRAMS = 64, EACH = 16, HANGS_AFTER_S = 300 };

static char folder[LONGEST_PATH];

/* ---- folders ---- */

static int removed(const char *path, const struct stat *info, int kind, struct FTW *where) {
    (void)info, (void)kind, (void)where;
    return remove(path);
}

static int make_folder(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/Mühle \xe9, programs.XXXXXX",
             base ? base : "/tmp"); /* with blanks, UTF-8 and a byte that is none */
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    return nftw(folder, removed, 16, FTW_DEPTH | FTW_PHYS);
}

static int n_files, n_svg, n_parts;

static int counted(const char *path, const struct stat *info, int kind, struct FTW *where) {
    (void)info, (void)where;
    size_t length = strlen(path);
    if (kind != FTW_F) return 0;
    n_files++;
    n_svg += length > 4 && strcmp(path + length - 4, ".svg") == 0;
    n_parts += length > 5 && strcmp(path + length - 5, ".part") == 0;
    return 0;
}

static void count_files(const char *path) {
    n_files = n_svg = n_parts = 0;
    nftw(path, counted, 16, FTW_PHYS);
}

static char *file_text(const char *path) {
    FILE *f = fopen(path, "rb");
    if (!f) return NULL;
    fseek(f, 0, SEEK_END);
    long size = ftell(f);
    rewind(f);
    char *text = malloc((size_t)size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)size, f), size);
    text[size] = '\0';
    fclose(f);
    return text;
}

/* ---- running ---- */

typedef struct {
    int status; /* exit status, or 1000 + signal */
    char *out, *err;
    double seconds;
} result;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sleep_seconds(double s) {
    struct timespec t = {(time_t)s, (long)(1e9 * (s - (double)(time_t)s))};
    nanosleep(&t, NULL);
}

/* Odd surroundings of the next run_program; zero: none. */
static struct {
    int signal;         /* that is sent, in place of SIGINT */
    bool closed;        /* the standard streams are closed */
    int output;         /* 1: is /dev/full, 2: is a pipe that nobody reads */
    long address_space; /* [B] that the program may take */
} odd;

static void make_odd(int *out) {
    int ends[2];
    if (odd.output == 1) *out = open("/dev/full", O_WRONLY);
    signal(SIGPIPE, SIG_DFL), signal(SIGHUP, SIG_DFL); /* the tests may be run by nohup, which programs heed */
    if (odd.output == 2 && pipe(ends) == 0) {
        close(ends[0]);
        *out = ends[1];
    }
    if (odd.address_space > 0) {
        struct rlimit limit = {(rlim_t)odd.address_space, (rlim_t)odd.address_space};
        setrlimit(RLIMIT_AS, &limit);
    }
}

/* Runs `program words...` (words end with NULL) in the folder. interrupt_after > 0: sends SIGINT then. */
static result run_program(const char *program, const char *const *words, long largest_file, double interrupt_after) {
    char *argv[40] = {NULL}, out_path[LONGEST_PATH + 20], err_path[LONGEST_PATH + 20];
    int argc = 0, code = 0;
    argv[argc++] = (char *)(uintptr_t)program;
    for (; *words && argc < 39; words++) argv[argc++] = (char *)(uintptr_t)*words;
    snprintf(out_path, sizeof out_path, "%s/said.out", folder);
    snprintf(err_path, sizeof err_path, "%s/said.err", folder);
    double began = now();
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int in = open("/dev/null", O_RDONLY), out = open(out_path, O_CREAT | O_TRUNC | O_WRONLY, 0600),
            err = open(err_path, O_CREAT | O_TRUNC | O_WRONLY, 0600);
        if (in < 0 || out < 0 || err < 0 || chdir(folder) != 0) _exit(99);
        make_odd(&out);
        dup2(in, 0);
        dup2(out, 1);
        dup2(err, 2);
        if (largest_file > 0) {
            struct rlimit limit = {(rlim_t)largest_file, (rlim_t)largest_file};
            signal(SIGXFSZ, SIG_IGN); /* a write beyond the limit then fails as on a full disk */
            setrlimit(RLIMIT_FSIZE, &limit);
        }
        for (int k = 0; k < 3 && odd.closed; k++) close(k);
        execv(program, argv);
        _exit(98);
    }
    bool interrupted = interrupt_after <= 0.0;
    while (waitpid(child, &code, WNOHANG) == 0) {
        sleep_seconds(0.01);
        if (!interrupted && now() - began > interrupt_after) {
            kill(child, odd.signal ? odd.signal : SIGINT);
            interrupted = true;
        }
        if (now() - began > HANGS_AFTER_S) kill(child, SIGKILL);
    }
    memset(&odd, 0, sizeof odd);
    result r;
    r.seconds = now() - began;
    r.status = WIFEXITED(code) ? WEXITSTATUS(code) : 1000 + WTERMSIG(code);
    r.out = file_text(out_path);
    r.err = file_text(err_path);
    assert_non_null(r.out);
    assert_non_null(r.err);
    remove(out_path);
    remove(err_path);
    return r;
}

static void forget(result *r) {
    free(r->out);
    free(r->err);
}

static int lines(const char *text) {
    int n = 0;
    for (; *text; text++) n += *text == '\n';
    return n;
}

/* ---- JSON: a reader that only says whether it is JSON ---- */

static const char *skip_value(const char *c);

static const char *skip_blank(const char *c) {
    while (c && (*c == ' ' || *c == '\n' || *c == '\t' || *c == '\r')) c++;
    return c;
}

static const char *skip_text(const char *c) {
    if (*c++ != '"') return NULL;
    for (; *c && *c != '"'; c++) {
        if ((unsigned char)*c < 32) return NULL;
        if (*c == '\\' && !*++c) return NULL;
    }
    return *c ? c + 1 : NULL;
}

static const char *skip_list(const char *c, char closer) {
    c = skip_blank(c + 1);
    if (*c == closer) return c + 1;
    while (c) {
        if (closer == '}') {
            c = skip_blank(c);
            c = skip_text(c);
            if (!c || *(c = skip_blank(c)) != ':') return NULL;
            c++;
        }
        c = skip_value(c);
        if (!c) return NULL;
        c = skip_blank(c);
        if (*c == closer) return c + 1;
        if (*c++ != ',') return NULL;
    }
    return NULL;
}

static const char *skip_value(const char *c) {
    static const char *const words[] = {"null", "true", "false"};
    c = skip_blank(c);
    if (*c == '{') return skip_list(c, '}');
    if (*c == '[') return skip_list(c, ']');
    if (*c == '"') return skip_text(c);
    for (int i = 0; i < 3; i++)
        if (strncmp(c, words[i], strlen(words[i])) == 0) return c + strlen(words[i]);
    if (*c != '-' && !isdigit((unsigned char)*c)) return NULL; /* no nan, no inf */
    char *end;
    strtod(c, &end);
    return end;
}

static bool is_json(const char *text) {
    const char *end = skip_value(text);
    return text[0] == '{' && end && !*skip_blank(end);
}

static void test_json_reader(void **state) {
    (void)state;
    assert_true(is_json("{\"a\": [1, -2e3, null, {\"b\": \"x\\\"y\"}], \"c\": true}\n") && is_json("{}"));
    assert_false(is_json("{\"a\": nan}") || is_json("{\"a\": 1,}") || is_json("{\"a\" 1}") ||
                 is_json("{\"a\": [1 2]}") || is_json("{\"a\": 1") || is_json("") || is_json("{} x") ||
                 is_json("{\"a\": inf}"));
}

/* ---- the tests; *state is the program's path ---- */

static void test_help(void **state) {
    static const char *const common[] = {"--help",  "--out DIR",   "--threads N", "--seed N",
                                         "--quiet", "--json FILE", "--quick"};
    const char *words[] = {"--help", NULL};
    result r = run_program(*state, words, 0, 0.0);
    assert_int_equal(r.status, 0);
    assert_string_equal(r.err, "");
    for (int i = 0; i < 7; i++) assert_non_null(strstr(r.out, common[i]));
    forget(&r);
    count_files(folder);
    assert_int_equal(n_files, 0);
}

static void test_version(void **state) {
    const char *words[] = {"--version", NULL};
    result r = run_program(*state, words, 0, 0.0);
    assert_int_equal(r.status, 0);
    assert_string_equal(r.err, "");
    assert_int_equal(lines(r.out), 1);
    if (!strstr(r.out, "Riddle ") || !isdigit((unsigned char)strstr(r.out, "Riddle ")[7])) fail_msg("said '%s'", r.out);
    forget(&r);
}

static void test_wrong_options(void **state) {
    static char endless[5000];
    memset(endless, 'x', sizeof endless - 1);
    for (int k = 0; k < (int)sizeof endless - 1; k += 100) endless[k] = '/';
    char in_a_file[LONGEST_PATH + 20], file[LONGEST_PATH + 20];
    snprintf(file, sizeof file, "%s/file", folder);
    snprintf(in_a_file, sizeof in_a_file, "%s/file/sub", folder);
    fclose(fopen(file, "w"));
    const char *const bad[][3] = {
        {"--no-such-thing", NULL, NULL}, {"--threads", "0", NULL},      {"--threads", "1000000000", NULL},
        {"--threads", "2x", NULL},       {"--threads", NULL, NULL},     {"--seed", "-1", NULL},
        {"--seed", "nan", NULL},         {"--seed=1.5", NULL, NULL},    {"--out", in_a_file, NULL},
        {"--out=", NULL, NULL},          {"--json", in_a_file, NULL},   {"--quiet=1", NULL, NULL},
        {"stray", NULL, NULL},           {"--json", folder, NULL},      {"--out", endless + 1, NULL},
        {"--out", endless + 4100, NULL}, {"--json", endless + 1, NULL},
    };
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        result r = run_program(*state, bad[i], 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] ||
            !strstr(r.err, strncmp(bad[i][0], "--", 2) == 0 ? "--" : bad[i][0]))
            fail_msg("%s %s: status %d, said '%s'", bad[i][0], bad[i][1] ? bad[i][1] : "", r.status, r.err);
        forget(&r);
    }
    count_files(folder);
    assert_int_equal(n_files, 1);
}

/* Each option with a value in --help, given numbers that are none: refused if it takes numbers, with status 2
   and one line. */
static void test_its_own_options(void **state) {
    const char *help[] = {"--help", NULL};
    result r = run_program(*state, help, 0, 0.0);
    int numeric = 0;
    for (char *row = strtok(r.out, "\n"); row; row = strtok(NULL, "\n")) {
        static const char *const values[] = {"nan", "inf", "1e999", "12x", "", "0x1"};
        char name[100], word[200];
        if (sscanf(row, " --%99[a-z0-9-]", name) != 1) continue;
        if (!strstr(row, " above ") && !strstr(row, " from ") && !strstr(row, " of at ")) continue;
        numeric++;
        for (int i = 0; i < 6; i++) {
            snprintf(word, sizeof word, "--%s=%s", name, values[i]);
            const char *words[] = {word, NULL};
            result s = run_program(*state, words, 0, 0.0);
            if (s.status != 2 || lines(s.err) != 1 || s.out[0] || !strstr(s.err, name))
                fail_msg("%s: status %d, said '%s'", word, s.status, s.err);
            forget(&s);
        }
    }
    forget(&r);
    assert_true(numeric > 0); /* --threads at least */
}

/* Each option that takes a file, given none that it can read: refused with status 2 and one line that names the option
   or the file. */
static void test_input_files(void **state) {
    static const char *const name[] = {"missing.csv", "folder", "empty", "noise"};
    char path[4][LONGEST_PATH + 20];
    for (int k = 0; k < 4; k++) snprintf(path[k], sizeof path[k], "%s/%s", folder, name[k]);
    mkdir(path[1], 0700);
    fclose(fopen(path[2], "w"));
    FILE *noise = fopen(path[3], "wb");
    for (int k = 0; k < 4000; k++) fputc((k * k * 31 + k / 7) & 255, noise);
    fclose(noise);
    const char *help[] = {"--help", NULL};
    result r = run_program(*state, help, 0, 0.0);
    for (char *row = strtok(r.out, "\n"); row; row = strtok(NULL, "\n")) {
        char option[100], kind[20], word[120];
        if (sscanf(row, " --%99[a-z0-9-] %19[A-Z]", option, kind) != 2 || strcmp(kind, "FILE") != 0) continue;
        if (strcmp(option, "json") == 0 || strcmp(option, "checkpoint") == 0) continue; /* these are written */
        snprintf(word, sizeof word, "--%s", option);
        for (int k = 0; k < 4; k++) {
            const char *words[] = {"--quick", word, path[k], NULL};
            result s = run_program(*state, words, 0, 0.0);
            if (s.status != 2 || lines(s.err) != 1 || s.out[0] || !strstr(s.err, option))
                fail_msg("%s %s: status %d, said '%s'", word, name[k], s.status, s.err);
            forget(&s);
        }
    }
    forget(&r);
    count_files(folder);
    assert_int_equal(n_files, 2);
}

/* What would take more memory than there is: refused in one line that tells both, before it is begun. The address
   sanitizer reserves more than any limit of the address space. */
static void test_memory(void **state) {
    if (SANITIZED) skip();
    static const struct {
        const char *program, *option;
        const char *words[8];
    } large[] = {{"hopper", "spheres", {"--scene", "dosta", "--spheres", "10000000"}},
                 {"hopper", "height", {"--width", "20", "--height", "20"}},
                 {"rotating_drum", "small", {"--small", "0.2", "--large", "0.5"}},
                 {"batch_screening", "mass", {"--mass", "1000"}},
                 {"batch_screening", "mass", {"--mass", "300", "--all-cases"}},
                 {"sieve_blocking", "load-kg-m2", {"--simulate", "--patch", "200", "--load-kg-m2", "100"}},
                 {"sieve_blocking", "load-kg-m2", {"--sweep", "--patch", "200", "--load-kg-m2", "30"}},
                 {"filter_cake", "voxel-um", {"--voxel-um", "0.5"}},
                 {"settling", "voxel-um", {"--case", "E1", "--voxel-um", "60"}},
                 {"dem_scaling", "spheres", {"--spheres", "20000000"}}};
    int tried = 0;
    for (int i = 0; i < (int)(sizeof large / sizeof *large); i++) {
        if (strcmp(strrchr(*state, '/') + 1, large[i].program) != 0) continue;
        odd.address_space = 2000000000L;
        result r = run_program(*state, large[i].words, 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] || !strstr(r.err, large[i].option) || !strstr(r.err, " GB "))
            fail_msg("%s %s: status %d, said '%s'", large[i].program, large[i].words[0], r.status, r.err);
        forget(&r);
        tried++;
    }
    if (!tried) skip();
}

/* A full device, and a pipe that nobody reads: told, and files whole or absent. */
static void test_streams(void **state) {
    const char *loud[] = {"--quick", "--out", "out", NULL}, *help[] = {"--help", NULL};
    odd.output = 1;
    result r = run_program(*state, help, 0, 0.0);
    if (r.status != 1 || lines(r.err) != 1) fail_msg("--help on a full device: status %d, said '%s'", r.status, r.err);
    forget(&r);
    odd.output = 2;
    r = run_program(*state, loud, 0, 0.0);
    if (r.status != 128 + SIGPIPE && r.status != 0)
        fail_msg("a pipe that nobody reads: status %d, said '%s'", r.status, r.err);
    forget(&r);
    count_files(folder);
    assert_int_equal(n_parts, 0);
}

/* A quick run, and its files; and one whose standard streams are closed, so that no file may take their place. What an
   example writes does not depend on the number of threads: figures, tables and particles of one and of two are the same
   bytes. (A benchmark's hold times.) */
static char one_thread[LONGEST_PATH + 20], two_threads[LONGEST_PATH + 20];
static int n_compared, n_different;

static int compared(const char *path, const struct stat *info, int kind, struct FTW *where) {
    (void)info, (void)where;
    char other[2 * LONGEST_PATH];
    if (kind != FTW_F) return 0;
    snprintf(other, sizeof other, "%s%s", two_threads, path + strlen(one_thread));
    FILE *a = fopen(path, "rb"), *b = fopen(other, "rb");
    int byte = 0;
    while (a && b && byte != EOF) {
        byte = getc(a);
        if (getc(b) != byte) break;
    }
    n_compared++;
    if (!a || !b || byte != EOF) {
        printf("differs: %s\n", path + strlen(one_thread) + 1);
        n_different++;
    }
    if (a) fclose(a);
    if (b) fclose(b);
    return 0;
}

static void assert_json(const char *path) {
    char *text = file_text(path);
    assert_non_null(text);
    assert_true(is_json(text));
    assert_non_null(strstr(text, "\"program\": "));
    free(text);
}

/* Figures that a quick run has nothing for are not written. */
static void assert_no_empty_figures(const char *program_path, const char *out) {
    static const char *const nothing[][2] = {{"/settling", "bottom.svg"},
                                             {"/filter_cake", "spheres.svg"},
                                             {"/filter_cake", "curve.svg"},
                                             {"/batch_screening", "apertures.svg"}};
    char path[LONGEST_PATH + 60];
    for (size_t k = 0; k < sizeof nothing / sizeof *nothing; k++) {
        snprintf(path, sizeof path, "%s/%s", out, nothing[k][1]);
        if (strcmp(strrchr(program_path, '/'), nothing[k][0]) == 0 && access(path, F_OK) == 0)
            fail_msg("%s shows nothing", path);
    }
}

static void test_quick_run(void **state) {
    char json[LONGEST_PATH + 20];
    snprintf(one_thread, sizeof one_thread, "%s/o u t/deep", folder);
    snprintf(two_threads, sizeof two_threads, "%s/2", folder);
    snprintf(json, sizeof json, "%s/result.json", folder);
    const char *one[] = {"--quick", "--quiet", "--threads", "1", "--out", one_thread, "--json", json, NULL};
    const char *two[] = {"--quick", "--quiet", "--threads", "2", "--out", two_threads, "--json", json, NULL};
    result r = run_program(*state, one, 0, 0.0);
    printf("%s --quick: %.1f s\n", strrchr(*state, '/') + 1, r.seconds);
    if (r.status != 0) fail_msg("status %d, said '%s'", r.status, r.err);
    assert_string_equal(r.out, "");
    assert_string_equal(r.err, "");
    forget(&r);
    assert_json(json);
    count_files(folder);
    assert_int_equal(n_parts, 0);
    assert_true(n_svg >= 1);
    assert_no_empty_figures(*state, one_thread);
    if (SANITIZED) return; /* one run shows what they look for, and takes ten times as long */
    odd.closed = true;
    r = run_program(*state, two, 0, 0.0);
    if (r.status != 0) fail_msg("closed streams: status %d", r.status);
    forget(&r);
    assert_json(json);
    if (!strstr(*state, "/examples/")) return;
    n_compared = n_different = 0;
    nftw(one_thread, compared, 16, FTW_PHYS);
    assert_true(n_compared >= 1);
    assert_int_equal(n_different, 0);
}

static void test_full_disk(void **state) {
    if (SANITIZED) skip(); /* a run as long as a whole one */
    const char *words[] = {"--quick", "--quiet", "--out", "out", "--json", "result.json", NULL};
    result r = run_program(*state, words, 2048, 0.0); /* no figure is so small */
    if (r.status != 1 || lines(r.err) < 1) fail_msg("status %d, said '%s'", r.status, r.err);
    if (strstr(r.err, "picture could not be written")) fail_msg("a picture without the reason: '%s'", r.err);
    forget(&r);
    count_files(folder);
    assert_int_equal(n_parts, 0);
}

static void interrupt(void **state, int number, double after) {
    const char *words[] = {"--out", "out", "--json", "result.json", NULL};
    char json[LONGEST_PATH + 20];
    odd.signal = number;
    result r = run_program(*state, words, 0, after);
    printf("%s stopped after %.2f s with status %d\n", strrchr(*state, '/') + 1, r.seconds, r.status);
    if (r.status != 128 + number && r.status != 0) fail_msg("status %d, said '%s'", r.status, r.err);
    if (r.status != 0) assert_int_equal(lines(strstr(r.err, "interrupted") ? strstr(r.err, "interrupted") : ""), 1);
    snprintf(json, sizeof json, "%s/result.json", folder);
    char *text = file_text(json);
    if (r.status == 0) assert_non_null(text); /* it was done before */
    if (text) assert_true(is_json(text));
    free(text);
    forget(&r);
    count_files(folder);
    assert_int_equal(n_parts, 0);
}

static void test_interrupt(void **state) { interrupt(state, SIGINT, 0.5); }
static void test_terminate(void **state) {
    interrupt(state, SIGTERM, 0.2);
    interrupt(state, SIGHUP, 0.1);
}

/* The studies of batch_screening: whole files, runs that are not run again, and the same answer from them. */
static void test_screening_studies(void **state) {
    const char *slash = strrchr(*state, '/');
    if (!slash || strcmp(slash, "/batch_screening") != 0) skip();
    static const char *const wrong[][3] = {
        {"--all-cases", "--vary", NULL}, {"--resume", NULL, NULL}, {"--all-cases", "--case=3", NULL}};
    for (int i = 0; i < 3; i++) {
        result r = run_program(*state, wrong[i], 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1) fail_msg("%s: status %d, said '%s'", wrong[i][0], r.status, r.err);
        forget(&r);
    }
    const char *first[] = {"--quick", "--quiet", "--all-cases", "--seeds", "2", "--time", "0.1", "--out", "all", NULL};
    const char *again[] = {"--quick", "--quiet", "--all-cases", "--seeds",   "2", "--time", "0.1",
                           "--out",   "all",     "--resume",    "--threads", "1", NULL};
    char path[6][LONGEST_PATH + 60];
    static const char *const name[6] = {
        "curves.csv", "case_05.json", "runs/case_05_seed_2_run.csv", "runs/case_07_seed_1.csv",
        "cases.svg",  "summary.json"};
    for (int i = 0; i < 6; i++) snprintf(path[i], sizeof path[i], "%s/all/%s", folder, name[i]);
    result r = run_program(*state, first, 0, 0.0);
    if (r.status != 0) fail_msg("status %d, said '%s'", r.status, r.err);
    forget(&r);
    char *curves = file_text(path[0]), *summary = file_text(path[5]), *run = file_text(path[3]);
    assert_true(curves && summary && run && is_json(summary) && lines(curves) == 1 + 27 * 2);
    /* one run is done again, all reports are written again */
    assert_int_equal(remove(path[1]) | remove(path[2]) | remove(path[4]), 0);
    /* Another answer in a file shows that it is read, not run. */
    char *half = strstr(run, "\n0,1,1,");
    assert_non_null(half);
    memcpy(half, "\n0,1,7,", 7);
    FILE *f = fopen(path[3], "wb");
    assert_true(f && fputs(run, f) >= 0 && fclose(f) == 0);
    r = run_program(*state, again, 0, 0.0);
    if (r.status != 0) fail_msg("status %d, said '%s'", r.status, r.err);
    forget(&r);
    char *resumed = file_text(path[0]), *redone = file_text(path[1]), *drawn = file_text(path[4]);
    assert_true(resumed && redone && drawn && is_json(redone));
    char *marked = strstr(resumed, ",0,1.000000,7.000000");
    assert_non_null(marked);
    memcpy(marked, ",0,1.000000,1.000000", 20);
    assert_string_equal(resumed, curves);
    free(curves), free(summary), free(run), free(resumed), free(redone), free(drawn);

    const char *plate[] = {"--quick", "--quiet",    "--scene", "closed-plate", "--vary",
                           "--json",  "plate.json", "--out",   "plate",        NULL};
    r = run_program(*state, plate, 0, 0.0);
    if (r.status != 0) fail_msg("status %d, said '%s'", r.status, r.err);
    forget(&r);
    snprintf(path[0], sizeof path[0], "%s/plate.json", folder);
    char *report = file_text(path[0]);
    assert_true(report && is_json(report) && strstr(report, "\"h_star_m\": [") &&
                strstr(report, "closed plate: water slows"));
    free(report);
}

/* What only wet_screen_designer does: from test curves of one's own, in three manners of writing them, to
   a prediction. */
static void test_own_screen(void **state) {
    char *at = strstr(*state, "/wet_screen_designer");
    if (!at) skip();
    char fitter[LONGEST_PATH + 20], place[LONGEST_PATH + 20], json[LONGEST_PATH + 20];
    snprintf(fitter, sizeof fitter, "%.*s/screen_fit", (int)(at - (char *)*state), (char *)*state);
    snprintf(place, sizeof place, "%s/lab.csv", folder);
    snprintf(json, sizeof json, "%s/result.json", folder);
    static const char *const headers[3] = {
        "case,amplitude_mm,frequency_hz,moisture,aperture_mm,time_s,size_mm,retained",
        "Case,Amplitude [mm],Frequency [rpm],Moisture [%],Aperture [mm],Time [min],Size [um],Retained [%]",
        "case,amplitude,frequency,moisture,aperture,time,size,retained"};
    static const double unit[3][7] = {{1e3, 1.0, 1.0, 1e3, 1.0, 1e3, 1.0},
                                      {1e3, 60.0, 100.0, 1e3, 1.0 / 60.0, 1e6, 100.0},
                                      {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}};
    double seconds[3];
    for (int f = 0; f < 3; f++) {
        FILE *file = fopen(place, "w");
        assert_non_null(file);
        fprintf(file, "%s\n", headers[f]);
        for (int k = 0; k < 5; k++)
            for (int c = 0; c < 3; c++)
                for (int j = 1; j <= 6; j++) {
                    double A = 0.001 + 0.0002 * (k % 3), hz = 45.0 + 5.0 * (k % 2), M = 0.025 * (k % 4),
                           d = 0.003 + 0.002 * c, t = 1.5 * j;
                    double y = exp(-0.5 * (A * hz / 0.05) * (1.0 - M) * (0.006 / d) * t) +
                               0.02 * sin(17.0 * k + 5.0 * c + 3.0 * j);
                    double row[7] = {A, hz, M, 0.008, t, d, y < 0.0 ? 0.0 : y > 1.0 ? 1.0 : y};
                    fprintf(file, "%d", k + 1);
                    for (int i = 0; i < 7; i++) fprintf(file, ",%.12g", row[i] * unit[f][i]);
                    fprintf(file, "\n");
                }
        fclose(file);
        const char *fit[] = {"--quick", "--quiet", "--data", "lab.csv", "--out", "lab", NULL};
        result r = run_program(fitter, fit, 0, 0.0);
        if (r.status != 0 || r.err[0]) fail_msg("screen_fit, file %d: %d, '%s'", f, r.status, r.err);
        forget(&r);
        const char *predict[] = {"--quiet",
                                 "--parameters",
                                 "lab/parameters.json",
                                 "--rosin-rammler",
                                 "6,2.5",
                                 "--classes",
                                 "3",
                                 "--out",
                                 "lab",
                                 "--json",
                                 json,
                                 NULL};
        r = run_program(*state, predict, 0, 0.0);
        if (r.status != 0 || r.err[0]) fail_msg("wet_screen_designer, file %d: %d, '%s'", f, r.status, r.err);
        forget(&r);
        char *text = file_text(json);
        assert_true(text && is_json(text));
        char *found = strstr(text, "\"subasinghe\"");
        assert_non_null(found);
        found = strstr(found, "\"time_s\":");
        assert_non_null(found);
        seconds[f] = strtod(found + 9, NULL);
        free(text);
    }
    assert_true(seconds[0] > 1.0 && seconds[0] < 20.0); /* the same screen, however it is written */
    assert_true(fabs(seconds[1] / seconds[0] - 1.0) < 1e-3 && fabs(seconds[2] / seconds[0] - 1.0) < 1e-3);
    /* a deck that is fed, whose holes block as counted tests say */
    char counts[LONGEST_PATH + 20];
    snprintf(counts, sizeof counts, "%s/tests.csv", folder);
    FILE *counted = fopen(counts, "w");
    assert_non_null(counted);
    fprintf(counted, "test,time_s,K,free_fraction\n");
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 6; j++)
            fprintf(counted, "%d,%d,%d,%.5f\n", k + 1, 10 * j, 4 + 4 * k,
                    0.6 + 0.05 * k + (0.39 - 0.05 * k) * exp(-0.3 * j) + 0.003 * sin(9.0 * j + k));
    fclose(counted);
    const char *fed[] = {"--quiet",
                         "--parameters",
                         "lab/parameters.json",
                         "--rosin-rammler",
                         "6,2.5",
                         "--classes",
                         "3",
                         "--out",
                         "lab",
                         "--json",
                         json,
                         "--tests",
                         "tests.csv",
                         "--feed-kg-s",
                         "4",
                         "--deck-width-m",
                         "1",
                         "--deck-length-m",
                         "3",
                         "--travel-m-s",
                         "0.3",
                         NULL};
    result r = run_program(*state, fed, 0, 0.0);
    if (r.status != 0 || r.err[0]) fail_msg("%d, '%s'", r.status, r.err);
    forget(&r);
    char *text = file_text(json);
    assert_true(text && is_json(text));
    char *found = strstr(text, "\"subasinghe\""), *deck = strstr(text, "\"deck\""), *number;
    assert_true(found && deck);
    number = strstr(found, "\"time_s\":");
    assert_true(number && strtod(number + 9, NULL) > seconds[0]); /* blocking takes time */
    number = strstr(found, "\"d50_low_m\":");
    assert_true(number && strtod(number + 12, NULL) > 0.004);
    number = strstr(deck, "\"passed_kg_per_s\":");
    assert_true(number && strtod(number + 18, NULL) > 0.1 && strtod(number + 18, NULL) < 4.0);
    free(text);
    const char *bad[][9] = {{"--parameters", "lab.csv"},
                            {"--tests", "lab.csv"},
                            {"--tests", "none.csv"},
                            {"--tests", "tests.csv", "--k1", "0.1", "--k2", "0.1"},
                            {"--feed-kg-s", "4", "--deck-width-m", "1", "--deck-length-m", "3", "--travel-m-s", "0.3"},
                            {"--travel-m-s", "0.3", "--parameters", "lab/parameters.json"}};
    const char *const named[] = {"parameters", "tests", "tests", "tests", "feed-kg-s", "feed-kg-s"};
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        r = run_program(*state, bad[i], 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] || !strstr(r.err, named[i]))
            fail_msg("%d: %d, '%s'", i, r.status, r.err);
        forget(&r);
    }
    const char *percent[] = {"--quick", "--data", "lab.csv", "--out", "lab", NULL};
    FILE *file = fopen(place, "w");
    assert_non_null(file);
    fprintf(file, "%s\n1,1,50,2.5,8,1,5,0.5\n", headers[0]);
    fclose(file);
    r = run_program(fitter, percent, 0, 0.0);
    if (r.status != 2 || lines(r.err) != 1 || !strstr(r.err, "percent")) fail_msg("%d, '%s'", r.status, r.err);
    forget(&r);
    /* a column twice, and columns that would be left out although they mean something */
    static const char *const columns[] = {"retained_percent", "moistur_percent", "moisture_ppm", "Load [t]",
                                          "wires_mm"};
    static const char *const row[] = {"50", "2.5", "2.5", "1", "2"};
    for (int k = 0; k < 5; k++) {
        file = fopen(place, "w");
        assert_non_null(file);
        fprintf(file, "case,amplitude_mm,frequency_hz,aperture_mm,time_s,size_mm,retained,%s\n1,1,50,8,1,5,0.5,%s\n",
                columns[k], row[k]);
        fclose(file);
        r = run_program(fitter, percent, 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] || !strstr(r.err, k ? columns[k] : "several"))
            fail_msg("%s: %d, '%s'", columns[k], r.status, r.err);
        forget(&r);
    }
}

/* What only sieve_blocking does: a simulation in place of readings. */
static void test_simulation(void **state) {
    if (!strstr(*state, "/sieve_blocking")) skip();
    const char *const good[][16] = {
        {"--simulate", "--k", "1.5", "--xh", "0.65", "--patch", "6", "--load-kg-m2", "0.3", "--vibrated-s", "0.4",
         "--overlap", "0.05"},
        {"--sweep", "--patch", "6", "--load-kg-m2", "0.2", "--vibrated-s", "0.2", "--overlap", "0.1"}};
    static const char *const keys[][6] = {
        {"\"simulation\"", "\"free_holes\"", "\"forced_through\"", "\"k1_per_s\"", "\"k2_per_s\"", "\"f_inf\""},
        {"\"sweep\"", "\"f_star\"", "\"f_star_table3\"", "\"k1_per_s\"", "\"k2_per_s\"", "\"f_inf_fitted\""}};
    char json[LONGEST_PATH + 20];
    snprintf(json, sizeof json, "%s/result.json", folder);
    for (int k = 0; k < 2; k++) {
        const char *words[24] = {NULL};
        int n = 0;
        while (good[k][n]) words[n] = good[k][n], n++;
        words[n++] = "--quiet", words[n++] = "--out", words[n++] = "out", words[n++] = "--json", words[n] = json;
        result r = run_program(*state, words, 0, 0.0);
        if (r.status != 0 || r.err[0]) fail_msg("status %d, said '%s'", r.status, r.err);
        forget(&r);
        char *text = file_text(json);
        assert_non_null(text);
        assert_true(is_json(text));
        for (int i = 0; i < 6; i++) assert_non_null(strstr(text, keys[k][i]));
        free(text);
    }
    const char *const bad[][6] = {{"--simulate", "--wire-mm", "0"},   {"--simulate", "--data", "x.csv"},
                                  {"--sweep", "--data", "x.csv"},     {"--simulate", "--patch", "5"},
                                  {"--simulate", "--overlap", "0"},   {"--simulate", "--vibrated-s", "0"},
                                  {"--simulate", "--friction", "-1"}, {"--sweep", "--load-kg-m2", "0"}};
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        result r = run_program(*state, bad[i], 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] || !strstr(r.err, bad[i][1]))
            fail_msg("%s: %d, '%s'", bad[i][1], r.status, r.err);
        forget(&r);
    }
    count_files(folder);
    assert_int_equal(n_parts, 0);
}

/* Bricks of paddle_gap: none is pressed into a paddle or another one deeper than its rounding in any step, where it
   would stay; --short takes few of them at a low loading; --cor may be any. */
static void test_paddle_bricks(void **state) {
    if (!strstr(*state, "/paddle_gap")) skip();
    char json[LONGEST_PATH + 20];
    snprintf(json, sizeof json, "%s/result.json", folder);
    const char *const words[] = {"--short", "--shape", "brick", "--cor", "0.625",  "--time-ms", "100", "--particles",
                                 "10",      "--quiet", "--out", "out",   "--json", json,        NULL};
    result r = run_program(*state, words, 0, 0.0);
    if (r.status != 0 || r.err[0]) fail_msg("status %d, said '%s'", r.status, r.err);
    forget(&r);
    char *text = file_text(json);
    assert_non_null(text);
    static const char *const said[] = {"\"core_overlaps\": 0,", "\"core_overlap_steps\": 0,", "\"unfinished\": 0,",
                                       "\"loading_kg_kg\": 3,", "\"cor\": 0.625,"};
    for (size_t k = 0; k < sizeof said / sizeof *said; k++) assert_non_null(strstr(text, said[k]));
    free(text);
    const char *const bad[][3] = {{"--cor", "0", NULL}, {"--cor", "1.01", NULL}, {"--cor", "nan", NULL}};
    for (int k = 0; k < 3; k++) {
        r = run_program(*state, bad[k], 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || !strstr(r.err, "--cor"))
            fail_msg("%s: %d, %s", bad[k][1], r.status, r.err);
        forget(&r);
    }
}

/* What angle_of_repose is given for a funnel and cannot be one: each is named, with the reason. */
static void test_funnels(void **state) {
    if (!strstr(*state, "/angle_of_repose")) skip();
    static const char text[] = "solid f\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n";
    char file[LONGEST_PATH + 20], missing[LONGEST_PATH + 20];
    snprintf(missing, sizeof missing, "%s/missing.stl", folder);
    snprintf(file, sizeof file, "%s/file.stl", folder);
    const struct {
        const char *path, *content, *scale, *reason;
    } bad[] = {{missing, NULL, "1", "No such file"}, {folder, NULL, "1", "directory"}, {file, "", "1", "triangle"},
               {file, "no facet", "1", "triangle"},  {file, text, "0.01", "wide"},     {file, text, "1e6", "wide"}};
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        FILE *f = bad[i].content ? fopen(file, "wb") : NULL;
        if (f) assert_true(fputs(bad[i].content, f) >= 0 && fclose(f) == 0);
        const char *words[] = {"--quick", "--stl", bad[i].path, "--stl-scale", bad[i].scale, NULL};
        result r = run_program(*state, words, 0, 0.0);
        if (r.status != 2 || lines(r.err) != 1 || r.out[0] || !strstr(r.err, bad[i].path) ||
            !strstr(r.err, bad[i].reason))
            fail_msg("%d: status %d, said '%s'", i, r.status, r.err);
        forget(&r);
    }
}

int main(void) {
    static const struct {
        const char *name;
        CMUnitTestFunction function;
    } each[EACH] = {{"help", test_help},
                    {"version", test_version},
                    {"wrong options", test_wrong_options},
                    {"its own options", test_its_own_options},
                    {"input files", test_input_files},
                    {"memory", test_memory},
                    {"streams", test_streams},
                    {"quick run, one and two threads", test_quick_run},
                    {"full disk", test_full_disk},
                    {"Ctrl-C", test_interrupt},
                    {"SIGTERM and SIGHUP", test_terminate},
                    {"screening studies", test_screening_studies},
                    {"simulation", test_simulation},
                    {"paddle bricks", test_paddle_bricks},
                    {"own screen", test_own_screen},
                    {"funnels", test_funnels}};
    static struct CMUnitTest tests[EACH * MOST_PROGRAMS + 1];
    static char names[EACH * MOST_PROGRAMS][120];
    const char *given = getenv("RIDDLE_PROGRAMS");
    char *list = malloc(given ? strlen(given) + 1 : 1);
    int n = 0;
    if (!list) return 1;
    list[0] = '\0';
    if (given) memcpy(list, given, strlen(given) + 1);
    for (char *program = strtok(list, "\n"); program && n + EACH <= EACH * MOST_PROGRAMS; program = strtok(NULL, "\n"))
        for (int i = 0; i < EACH; i++, n++) {
            char *slash = strrchr(program, '/');
            snprintf(names[n], sizeof names[n], "%.80s: %s", slash ? slash + 1 : program, each[i].name);
            struct CMUnitTest test = {names[n], each[i].function, make_folder, remove_folder, program};
            tests[n] = test;
        }
    struct CMUnitTest reader = {"JSON reader", test_json_reader, NULL, NULL, NULL};
    tests[n++] = reader;
    int status = _cmocka_run_group_tests("programs", tests, (size_t)n, NULL, NULL);
    free(list);
    return status;
}
