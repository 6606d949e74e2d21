/* riddle - a scene from a file, without C: riddle run scene.yaml

   The file (YAML, or JSON, which is a part of it) says what there is: materials, walls and how they move, shapes,
   feeds, liquid, what is measured, when to stop. docs/scene_files.md lists every key. `riddle run --template screen`
   writes one to begin with. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "earlier.h"
#include "report.h"
#include "scene.h"
#include "scene_check.h"
#include "scene_materials.h"
#include "scene_same.h"
#include "scene_shapes.h"
#include "templates.h"

enum { SCENE_MB = 16 }; /* at most */
static const char state_name[] = "scene.state";
static const double OVERLAP_MAX = 0.1; /* of a diameter: beyond it contacts are no contacts any more */
static const char usage[] = "usage: riddle run FILE [options]; riddle run --template hopper|screen|drum|box|shapes; "
                            "riddle keys; riddle materials; riddle run --help";

typedef struct job {
    const char *file;
    program self;
    bool again, check;
    int size[2]; /* of pictures [pixels] */
    char **set;  /* [sets] "key=value" */
    int sets;
    bool halfway;         /* stopped while feeds looked for places, or failed: not a state to go on from */
    double saved;         /* time of the save that this run has written last [s]; NaN: none */
    double save_at;       /* time of the last save, or of the beginning [s] */
    const stop_def *stop; /* what has ended the run, or NULL */
    tree_file tree;
    scene_def def;
    scene s;
    char *keys; /* of the scene, which a save has, too */
    report *r;
} job;

static const char *called = "riddle"; /* how the user has called this program */

static int refuse(const char *line) {
    fprintf(stderr, "riddle: %s\n", line);
    return 2;
}

/* ---- templates ---- */

static int write_template(const char *name) {
    char target[64];
    const scene_template *found = templates;
    while (found->name && strcmp(found->name, name) != 0) found++;
    if (!found->name) {
        fprintf(stderr, "riddle: --template %.60s: allowed: hopper, screen, drum, box or shapes\n", name);
        return 2;
    }
    snprintf(target, sizeof target, "%s.yaml", name);
    FILE *there = fopen(target, "rb");
    if (there) {
        fclose(there);
        fprintf(stderr, "riddle: %s is there already: move it away first\n", target);
        return 2;
    }
    riddle_io_file *file = riddle_io_open(NULL, target);
    for (const char *const *line = found->line; *line; line++) riddle_io_write(file, *line, strlen(*line));
    if (riddle_io_close(file) != RIDDLE_IO_OK) return 1;
    common_print("%s is written. Now: %s run %s\n", target, called, target);
    return common_exit_status();
}

/* ---- reading ---- */

/* Sets KEY=VALUE; 0, or -1 with the message in the tree, or 2 where it is said already. */
static int set_value(job *j, const char *words) {
    char path[200], message[200];
    const char *equals = strchr(words, '=');
    if (!equals || equals == words || (size_t)(equals - words) >= sizeof path) {
        snprintf(message, sizeof message,
                 "--set %.100s: allowed: KEY=VALUE, such as materials.glass.density=2600, or @FILE of such lines",
                 words);
        return refuse(message);
    }
    snprintf(path, sizeof path, "%.*s", (int)(equals - words), words);
    return tree_set(&j->tree, path, equals + 1);
}

/* The same for each line of a file; empty ones and those that begin with # are left out. */
static int set_values_of(job *j, const char *name) {
    char message[400];
    size_t size;
    char *text = input_read_most(name, SCENE_MB, &size, message, sizeof message), *next = NULL;
    int failed = text ? 0 : refuse(message);
    for (char *line = text; line && *line && !failed; line = next) {
        char *end = line + strcspn(line, "\r\n");
        next = end + strspn(end, "\r\n");
        *end = '\0';
        if (line[0] != '\0' && line[0] != '#') failed = set_value(j, line);
    }
    free(text);
    return failed;
}

static int read_scene(job *j, bool seed_given) {
    char message[400];
    size_t size;
    char *text = input_read_most(j->file, SCENE_MB, &size, message, sizeof message);
    if (!text) return refuse(message);
    int failed = tree_read(&j->tree, j->file, text, size);
    free(text);
    for (int k = 0; k < j->sets && !failed; k++)
        failed = j->set[k][0] == '@' ? set_values_of(j, j->set[k] + 1) : set_value(j, j->set[k]);
    if (failed == 2) return 2;
    if (failed || scene_read(&j->tree, &j->def)) return refuse(j->tree.message);
    if (j->self.quick) j->def.duration *= 0.1;
    if (scene_make(&j->s, &j->def, &j->tree, seed_given ? j->self.seed : (uint64_t)j->def.seed, j->self.threads))
        return refuse(j->tree.message);
    j->r = report_open(&j->s, j->self.out, j->size);
    j->keys = scene_keys(&j->s);
    return j->r && j->keys ? 0 : refuse(j->tree.message);
}

/* The keys of the scene of a save against those of this one. */
static int exchange_keys(job *j, scene_state *io) {
    uint64_t size = strlen(j->keys) + 1;
    char *saved = j->keys;
    state_whole(io, &size);
    if (io->reading && !io->failed)
        saved = size > 0 && size <= io->size - io->at ? tree_memory(&j->tree, (size_t)size) : NULL;
    if (!saved) io->failed = 1;
    state_bytes(io, saved, (size_t)size);
    if (!io->reading || io->failed) return io->failed;
    saved[size - 1] = '\0';
    return scene_same(&j->s, j->keys, saved);
}

static int exchange(job *j, scene_state *io) {
    const int failed = exchange_keys(j, io) || scene_exchange(&j->s, io) || report_exchange(j->r, io);
    return state_finish(io) || failed ? -1 : 0;
}

static int read_state(job *j) {
    char path[1000], message[400];
    size_t size;
    scene_state io;
    unsigned char *bytes = (unsigned char *)input_read(riddle_io_path(path, sizeof path, j->self.out, state_name),
                                                       &size, message, sizeof message);
    if (!bytes) return refuse(message);
    const int begun = state_begin_reading(&io, bytes, size), failed = begun || exchange(j, &io);
    state_free(&io);
    if (!failed) return 0;
    if (j->tree.message[0]) return refuse(j->tree.message);
    snprintf(message, sizeof message, "--continue: %.300s: %s", path,
             begun == 1 ? "a save of another version of riddle run, which alone goes on from it" : "no whole save");
    return refuse(message);
}

static int write_state(job *j) {
    scene_state io;
    state_begin_writing(&io);
    int failed = exchange(j, &io);
    if (failed) common_fail("%s: out of memory", state_name);
    else {
        riddle_io_file *file = riddle_io_open(j->self.out, state_name);
        riddle_io_write(file, io.bytes, io.size);
        failed = riddle_io_close(file) != RIDDLE_IO_OK;
        if (!failed) j->saved = scene_time(&j->s);
    }
    state_free(&io);
    return failed;
}

/* ---- running ---- */

/* Says why the scene cannot go on, materials by their names. */
static void fail_run(const job *j, dem_status status) {
    const dem_world *w = &j->s.world;
    const material_def *m = j->s.def->materials.item;
    if (status == DEM_PAIR_NOT_SET)
        common_fail("t = %.6g s: %s and %s touch: how, is not said under contacts", w->time,
                    m[w->failed_pair[0]].part.name, m[w->failed_pair[1]].part.name);
    else
        common_fail("t = %.6g s: %s (particle %llu)", w->time, dem_status_text(status),
                    (unsigned long long)w->failed_id);
}

static void end_early(job *j, dem_status status) {
    j->halfway = true;
    if (status != DEM_STOPPED) fail_run(j, status);
}

/* The save, the rest of the duration, the last row. */
static const stop_def *end_run(job *j, const stop_def *stop) {
    double left;
    if (common_exit_status() != 1) write_state(j);
    if (!stop && !common_interrupted() && scene_near_end(&j->s, &left) && left > 0.0) {
        const dem_status status = scene_finish(&j->s, left);
        if (status != DEM_OK) return end_early(j, status), NULL;
    }
    const stop_def *at_end = report_end(j->r);
    return stop || common_interrupted() ? stop : at_end;
}

/* Measures, saves, and runs a tick. Returns false at the end of the run; j->stop is the condition that ended it, if
   one did. */
static bool advance(job *j) {
    const double save = j->def.output.save;
    double left;
    if (!j->stop) j->stop = report_look(j->r);
    const double now = scene_time(&j->s);
    if (j->stop || common_interrupted() || scene_near_end(&j->s, &left)) return false;
    if (save > 0.0 && now - j->save_at >= save * (1.0 - 1e-9)) write_state(j), j->save_at = now;
    const dem_status status = scene_advance(&j->s);
    if (status != DEM_OK) end_early(j, status);
    return status == DEM_OK;
}

static void run(job *j) {
    progress bar;
    j->save_at = scene_time(&j->s);
    progress_begin(&bar, "running", j->def.duration);
    while (advance(j)) progress_update(&bar, scene_time(&j->s));
    if (!j->halfway) j->stop = end_run(j, j->stop);
    progress_end(&bar);
}

static void tell(const job *j, const char *written) {
    const stop_def *stop = j->stop;
    const scene_lack lack = scene_missed(&j->s);
    char hash[24], saved[80] = "", lag[200] = "";
    const double last_tick = j->s.ticks * j->s.tick;
    const int64_t deep = dem_core_overlap_steps(&j->s.world);
    json *out = json_open(j->self.json);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)dem_hash(&j->s.world));
    json_program(out, &j->self);
    json_string(out, "scene", j->file);
    json_string(out, "stopped_by", stop ? stop->column : NULL);
    json_number(out, "time_s", scene_time(&j->s));
    json_number(out, "time_step_s", j->s.world.def.dt);
    json_number(out, "missed_particles", lack.missed);
    json_number(out, "missed_kg", lack.missed_mass);
    json_object_begin(out, "fed_kg");
    for (int g = 0; g < j->s.groups; g++) json_number(out, j->s.group[g].name, j->s.group[g].fed);
    json_object_end(out);
    json_number(out, "feed_lag_kg", lack.late);
    json_number(out, "feed_lag_share", lack.asked > 0.0 ? lack.late / lack.asked : 0.0);
    json_integer(out, "core_overlap_steps", deep);
    json_string(out, "hash", hash);
    report_json(j->r, out);
    json_close(out);
    if (stop) common_print("stopped at %g s: %s\n", scene_time(&j->s), stop->column);
    report_say(j->r);
    if (lack.missed_mass > 0.0)
        common_print("%g kg found no place: a larger region, a longer way or more speed gives it one\n",
                     lack.missed_mass);
    if (report_overlap(j->r) > OVERLAP_MAX)
        common_print("overlap reached %.0f %% of a diameter: %s\n", 100.0 * report_overlap(j->r),
                     isnan(j->def.time_step) ? "the stiffness is too small"
                                             : "the stiffness is too small, or the time step too large");
    if (deep > 0)
        common_print("bodies were in each other or in walls, deeper than their rounding (%lld bodies times steps): the "
                     "stiffness is too small\n",
                     (long long)deep);
    if (j->saved < last_tick) snprintf(saved, sizeof saved, ", %s of %g s", state_name, j->saved);
    else if (!isnan(j->saved)) snprintf(saved, sizeof saved, ", %s", state_name);
    if (lack.late > 0.0)
        snprintf(lag, sizeof lag,
                 "; the feed lags by %.4g kg of %.4g kg (%.3g %%): a larger region, a longer way or more speed gives "
                 "it room",
                 lack.late, lack.asked, 100.0 * lack.late / lack.asked);
    common_print("%g s in steps of %.3g s; %s has %s%s%s\n", scene_time(&j->s), j->s.world.def.dt, j->self.out, written,
                 saved, lag);
}

static int hold_folder(const job *j) {
    char message[800];
    if (output_hold_folder(j->self.out) == 0) return 0;
    snprintf(message, sizeof message, "--out %s: another riddle run is writing there", j->self.out);
    return refuse(message);
}

static void tell_fits(job *j) {
    char line[300];
    for (int k = 0; k < j->s.def->shapes.n; k++)
        if (scene_say_fit(&j->s, k, line, sizeof line)) common_print("%s\n", line);
}

/* What --check says: sizes, what is allowed and yet may be a mistake; 2 where a pair has no contact. */
static int tell_check(job *j) {
    char line[300];
    const scene_size size = scene_estimate(&j->s);
    common_print("%s: walls: %d, feeds: %d, time step: %.3g s\n", j->file, j->s.world.walls, j->s.sources,
                 j->s.world.def.dt);
    scene_say_size(&size, line, sizeof line);
    common_print("%s\n%s", line, j->tree.notes);
    tell_fits(j);
    if (!scene_lacks_contact(&j->s, line, sizeof line)) return 0;
    return tree_fail(&j->tree, NULL, "%s", line), refuse(j->tree.message);
}

/* Before a run that takes more than a minute, and where it may end early. */
static void tell_begin(job *j) {
    char line[300];
    const scene_size size = scene_estimate(&j->s);
    scene_say_size(&size, line, sizeof line);
    if (size.seconds > 60.0) common_print("%s\n", line);
    tell_fits(j);
    if (scene_lacks_contact(&j->s, line, sizeof line)) common_print("%s: %s\n", j->file, line);
}

static int run_scene(job *j, bool seed_given) {
    int failed = read_scene(j, seed_given);
    if (!failed && !j->check) failed = hold_folder(j);
    if (!failed && j->again) failed = read_state(j);
    if (!failed && j->check) failed = tell_check(j);
    else if (!failed) {
        tell_begin(j);
        if (!j->again) report_begin(j->r);
        run(j);
        /* One that failed before it saved would leave a save that goes on from what no table shows. */
        if (!j->again && isnan(j->saved)) earlier_remove(j->self.out, state_name, state_head);
        tell(j, report_write(j->r));
    }
    report_free(j->r);
    scene_free(&j->s);
    tree_free(&j->tree);
    return failed ? failed : common_exit_status();
}

/* ---- the command line ---- */

static bool word_given(int argc, char **argv, const char *name) {
    const size_t length = strlen(name);
    for (int k = 1; k < argc; k++)
        if (strncmp(argv[k], name, length) == 0 && (argv[k][length] == '\0' || argv[k][length] == '=')) return true;
    return false;
}

/* The place of the scene's file among the words behind "run", before or after the options; 0: there is none. */
static int place_of_file(int argc, char **argv) {
    static const char *const valued[] = {"--out", "--threads", "--seed", "--json", "--template", "--set", "--size"};
    for (int k = 2; k < argc; k++) {
        bool takes = false;
        for (size_t v = 0; v < sizeof valued / sizeof *valued; v++) takes |= strcmp(argv[k], valued[v]) == 0;
        if (takes) k++;
        else if (argv[k][0] != '-') return k;
    }
    return 0;
}

/* The options without "run FILE" and those of --set, and with --out out/<name of the file> where none is given. */
static int rest_of(job *j, int argc, char **argv, int place, char *out, size_t size, char **rest) {
    int n = 0;
    rest[n++] = argv[0];
    if (place && !word_given(argc, argv, "--out")) {
        const char *file = argv[place], *slash = strrchr(file, '/'), *stem = slash ? slash + 1 : file,
                   *dot = strrchr(stem, '.');
        snprintf(out, size, "out/%.*s", dot && dot > stem ? (int)(dot - stem) : (int)strlen(stem), stem);
        rest[n++] = (char *)"--out";
        rest[n++] = out;
    }
    for (int k = 2; k < argc; k++) {
        const bool apart = strcmp(argv[k], "--set") == 0 && k + 1 < argc;
        if (apart) j->set[j->sets++] = argv[++k];
        else if (strncmp(argv[k], "--set=", 6) == 0) j->set[j->sets++] = argv[k] + 6;
        else if (k != place) rest[n++] = argv[k];
    }
    rest[n] = NULL;
    return n;
}

int main(int argc, char **argv) {
    static job j;
    j.size[0] = 960, j.size[1] = 640;
    j.saved = (double)NAN;
    char out[600];
    const char *pattern = NULL, *set = NULL;
    if (argc > 0) called = argv[0];
    option options[] = {
        option_flag("continue", &j.again,
                    "go on from the save in --out, with the same bits as if it had never stopped"),
        option_flag("check", &j.check, "read the file and build the scene, but do not run"),
        option_string("set", "KEY=VALUE", &set,
                      "another value than the file's: materials.glass.density=2600, feeds[1].rate='2 t/h', "
                      "contacts.glass-steel.friction=0.4; may be given often; @FILE: of each line of a file"),
        option_size("size", j.size, "of scene.png and the movie [pixels]"),
        option_string("template", "NAME", &pattern,
                      "write NAME.yaml, to begin with: hopper, screen, drum, box or shapes"),
    };
    if (argc == 2 && strcmp(argv[1], "keys") == 0) {
        common_open_standard_streams();
        fields_describe(&scene_section);
        return common_exit_status();
    }
    if (argc == 2 && strcmp(argv[1], "materials") == 0) {
        common_open_standard_streams();
        scene_list_materials();
        return common_exit_status();
    }
    const int help = argc >= 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "--version") == 0);
    if (!help && (argc < 2 || strcmp(argv[1], "run") != 0)) return refuse(usage);
    const int place = help ? 0 : place_of_file(argc, argv);
    j.file = place ? argv[place] : NULL;
    /* Without a folder for output. */
    if (!j.file && argc == 4 && strcmp(argv[2], "--template") == 0) return write_template(argv[3]);
    char **rest = malloc(2 * ((size_t)argc + 4) * sizeof *rest);
    if (!rest) return 1;
    j.set = rest + argc + 4;
    const int n = help ? argc : rest_of(&j, argc, argv, place, out, sizeof out, rest);
    if (!help && !j.file && !word_given(argc, argv, "--help") && !word_given(argc, argv, "--version")) {
        free(rest);
        return refuse(word_given(argc, argv, "--template") ? "--template NAME stands alone" : usage);
    }
    program_say_defaults("out/<name of the scene>", "the scene's, else 1");
    j.self = program_start("riddle",
                           "runs a scene from a YAML or JSON file.\n\n"
                           "usage: riddle run FILE [options]\n"
                           "       riddle run --template hopper|screen|drum|box|shapes\n"
                           "       riddle keys; riddle materials",
                           options, sizeof options / sizeof *options, n, help ? argv : rest);
    const int status =
        pattern ? refuse("--template NAME stands alone") : run_scene(&j, word_given(argc, argv, "--seed"));
    free(rest);
    return status;
}
