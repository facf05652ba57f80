/* The program as a person or a script meets it: every mistake is one line and the right exit code, no run leaves half a
 * file, and no option that may not change pixels does. Runs $AMBIANCE (build/ambiance when unset) through the shell in
 * a folder of its own, where $A is the program (under a time limit), $P the bare program and $S a scene. */
#include <ctype.h>
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static bool has_scene;

typedef struct result {
    int code; /* exit code; 128 + signal when killed */
    char out[1 << 16], err[1 << 14];
} result;

static void read_text(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t length = fread(text, 1, size - 1, file);
    text[length] = '\0';
    fclose(file);
}

static result run(const char *command)
{
    static result r;
    char line[4096];
    assert_true((size_t)snprintf(line, sizeof line, "{ %s\n} >.out 2>.err </dev/null", command) < sizeof line);
    int status = system(line);
    r.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    read_text(".out", r.out, sizeof r.out);
    read_text(".err", r.err, sizeof r.err);
    return r;
}

static bool exists(const char *path)
{
    struct stat info;
    return lstat(path, &info) == 0;
}

static void succeeds(const char *command)
{
    result r = run(command);
    if (r.code != 0 || r.err[0])
        fail_msg("%s\nexit code %d\n%s", command, r.code, r.err);
}

/* Exit code, exactly one line, that starts with "ambiance: " and names what it should; nothing on standard output. */
static void fails(int code, const char *command, const char *expected)
{
    result r = run(command);
    const char *newline = strchr(r.err, '\n');
    bool is_one_line = newline && newline[1] == '\0' && strncmp(r.err, "ambiance: ", 10) == 0;
    for (const char *c = r.err; newline && c < newline; c++)
        is_one_line = is_one_line && !iscntrl((unsigned char)*c);
    if (r.code != code || !is_one_line || r.out[0] || !strstr(r.err, expected))
        fail_msg("%s\nexpected exit code %d and \"%s\"\ngot %d and: %s%s", command, code, expected, r.code, r.err,
                 r.out);
}

static void needs_scene(void)
{
    if (!has_scene)
        skip();
}

/* ---- commands and options ---------------------------------------------------------------------------------------- */

static void help_and_version(void **state)
{
    (void)state;
    static const char *const commands[] = {"list", "render", "info", "compare"};
    succeeds("$A --help");
    succeeds("$A --version");
    result r = run("$A --version");
    assert_memory_equal(r.out, "ambiance ", 9);
    assert_true(isdigit((unsigned char)r.out[9]));
    for (size_t i = 0; i < 4; i++) {
        char line[128], usage[64];
        snprintf(line, sizeof line, "$A %s --help", commands[i]);
        succeeds(line);
        r = run(line);
        snprintf(usage, sizeof usage, "usage: ambiance %s", commands[i]);
        assert_non_null(strstr(r.out, usage));
    }
    fails(2, "$A", "no command");
    fails(2, "$A rendr", "unknown command: rendr; did you mean render?");
    fails(2, "$A ''", "unknown command: ; known: list, render, info, compare");
    fails(2, "$A \"$(printf 'a\\nb\\033[1m')\"", "unknown command: a?b?[1m");
}

static void options(void **state)
{
    (void)state;
    fails(2, "$A render x --tiime 3", "unknown option: --tiime; did you mean --time?");
    fails(2, "$A render x --qqqqqqqqqq", "unknown option: --qqqqqqqqqq; see `ambiance render --help`");
    fails(2, "$A render x -x", "unknown option: -x");
    fails(2, "$A render x --time", "--time: option without its value");
    fails(2, "$A render x -o", "-o: option without its value");
    fails(2, "$A render x --json=3", "--json: the option takes no value");
    fails(2, "$A compare --frobnicate a b", "unknown option: --frobnicate");
    fails(2, "$A info --jsn a", "unknown option: --jsn; did you mean --json?");
    fails(2, "$A list --pst", "unknown option: --pst; did you mean --post?");
    fails(2, "$A list a b", "list: unexpected argument: b");
    fails(2, "$A list --assets a", "list: unexpected argument: a");
    fails(2, "$A list --post nopass", "unknown post pass: nopass; ");
    fails(2, "$A info", "info: no file");
    fails(2, "$A render", "render: no scene");
    fails(2, "$A render a b", "render: unexpected argument: b; one scene is expected");
}

static void listings(void **state)
{
    (void)state;
    succeeds("$A list");
    succeeds("$A list --json");
    succeeds("$A list --post");
    succeeds("$A list --post --json");
    succeeds("$A list --assets --assets-dir builtin");
    succeeds("for p in $($A list --post --names); do $A list --post $p && $A list --post $p --json || exit 1; done");
    succeeds("for s in $($A list --names); do $A list $s && $A list $s --json || exit 1; done");
    fails(3, "$A list --post >/dev/full", "standard output: No space left on device");
    fails(3, "$A list --post --json >/dev/full", "standard output: No space left on device");
    fails(2, "$A list nosuchscenehere", "unknown scene: nosuchscenehere; ");
    fails(3, "$A list --assets --assets-dir missing", "--assets: missing; ");
}

/* ---- render ------------------------------------------------------------------------------------------------------ */

static void render_values(void **state)
{
    (void)state;
    needs_scene();
    fails(2, "$A render nosuchscenehere", "unknown scene: nosuchscenehere; known: ");
    fails(2, "$A render ${S}x", "did you mean ");
    fails(2, "$A render $S --time soon", "--time: soon; allowed: ");
    fails(2, "$A render $S --time nan", "--time: nan; allowed: ");
    fails(2, "$A render $S --time inf", "--time: inf; allowed: ");
    fails(2, "$A render $S --time 1e300", "--time: 1e300; allowed: ");
    fails(2, "$A render $S --time 3s", "--time: 3s; allowed: ");
    static const char *const sizes[] = {
        "0x4", "4x0", "-4x4", "4x-4",  "1000000x4", "4x1000000", "65536x65536", "99999999999999999999x4",
        "4",   "4x",  "x4",   "4x4x4", "",          "4,4"};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        char line[128], expected[128];
        snprintf(line, sizeof line, "$A render $S --size '%s'", sizes[i]);
        snprintf(expected, sizeof expected, "--size: %s; allowed: WIDTHxHEIGHT, each 1 to 65536", sizes[i]);
        fails(2, line, expected);
    }
    fails(2, "$A render $S --threads -1", "--threads: -1; allowed: whole numbers from 0 to 1024");
    fails(2, "$A render $S --threads 1025", "--threads: 1025; allowed: ");
    fails(2, "$A render $S --threads two", "--threads: two; allowed: ");
    fails(2, "$A render $S --threads 99999999999999999999", "--threads: 99999999999999999999; allowed: ");
    fails(2, "$A render $S --isa avx9", "--isa: avx9; allowed: auto, v2, v3, v4");
    fails(2, "$A render $S --frame -3", "--frame: -3; allowed: ");
    fails(2, "$A render $S --set nothing", "--set: nothing; NAME=VALUE is expected");
    fails(2, "$A render $S --set =3", "--set: =3; NAME=VALUE is expected");
    fails(2, "$A render $S --set zzzzzzzzzzz=3", "zzzzzzzzzzz");
    fails(2, "$A render $S --set $(printf '%0200d' 0)=3", "--set: 000");
    fails(2, "$A render $S --aov nosuchaovhere -o a.exr", "unknown AOV: nosuchaovhere");
    fails(2, "$A render $S --aov all -o a.png", "--aov: all; AOVs are written to .exr files");
    fails(2, "$A render $S --aov '' -o a.exr", "unknown AOV: ; ");
    fails(2, "$A render $S --post nosuchpasshere --size 8x8", "nosuchpasshere");
    fails(2, "$A render $S --post bloom:threshold=-7 --size 8x8", "threshold");
    fails(2, "$A render $S --post bloom:thresold=1 --size 8x8", "thresold");
    assert_false(exists("a.exr"));
}

/* Every parameter of every scene refuses nonsense; of one scene, also what lies outside the range of any. */
static void render_parameters(void **state)
{
    (void)state;
    needs_scene();
    result r = run("for s in $($A list --names); do for p in $($A list $s --names); do\n"
                   "$P render $s --set $p=nonsense 2>/dev/null; c=$?; [ $c = 2 ] || echo $s $p nonsense $c\n"
                   "done; done; for p in $($A list $S --names); do for v in '' 1e39 nan,nan,nan 1,2,3,4; do\n"
                   "$P render $S --set $p=$v 2>/dev/null; c=$?; [ $c = 2 ] || echo $S $p $v $c\n"
                   "done; done");
    assert_string_equal(r.out, "");
}

static void render_outputs(void **state)
{
    (void)state;
    needs_scene();
    fails(2, "$A render $S -o a.jpg", "output: a.jpg; allowed: names that end in .exr or .png");
    fails(2, "$A render $S -o ''", "output: ; allowed: ");
    fails(2, "$A render $S -o .png", "output: .png; allowed: ");
    fails(3, "$A render $S -o missing/a.png", "output: missing/a.png; its folder: No such file or directory");
    fails(3, "mkdir -p folder.png; $A render $S -o folder.png", "output: folder.png; it is a folder");
    fails(3, "touch file; $A render $S -o file/a.png", "file/a.png");
    fails(2, "$A render $S -o $(printf '%05000d' 0).png", "output: name longer than 4095 characters");
    fails(3, "$A render $S --assets builtin --size 8x8 -o $(printf '%0300d' 0).png", "File name too long");
    fails(3, "$A render $S --assets missing -o a.png", "--assets: missing; a folder, or `builtin`, is expected");
    fails(3, "$A render $S --pack missing -o a.png", "--pack: missing; a folder is expected");
    fails(3, "$A render $S --assets builtin --size 8x8 -o /proc/a.exr", "/proc/a.exr");
    /* A full disk, a full device, a vanished folder: the line, no file, nothing left behind. */
    fails(3, "ln -sf /dev/full full.exr; $A render $S --assets builtin --size 8x8 -o full.exr",
          "No space left on device");
    fails(3, "ln -sf /dev/full full.png; $A render $S --assets builtin --size 8x8 -o full.png",
          "No space left on device");
    fails(3, "ulimit -f 8; $A render $S --assets builtin --size 256x256 -o big.exr", "big.exr");
    fails(3, "ulimit -f 8; $A render $S --assets builtin --size 256x256 -o big.png", "big.png");
    fails(3, "mkdir gone; cd gone; rmdir ../gone; $A render $S --assets builtin --size 8x8 -o a.png", "a.png");
    assert_false(exists("big.exr"));
    assert_false(exists("big.png"));
    result r = run("find . -name '*ambiance-tmp*'");
    assert_string_equal(r.out, "");
}

static void an_old_file_survives_a_failed_write(void **state)
{
    (void)state;
    needs_scene();
    succeeds("printf old >kept.exr; printf old >expected");
    fails(3, "ulimit -f 8; $A render $S --assets builtin --size 256x256 -o kept.exr", "kept.exr");
    succeeds("cmp kept.exr expected");
}

/* Killed as soon as the temporary file shows itself, and at other moments: the old file or the new one. */
static void killed_in_mid_write(void **state)
{
    (void)state;
    needs_scene();
    succeeds("$A render $S --assets builtin --size 640x480 --quiet -o whole.exr");
    succeeds("printf old >old; cp old hit.exr");
    result r = run("seen=0; for i in 1 2 3 4; do\n"
                   "$P render $S --assets builtin --size 640x480 --quiet -o hit.exr & p=$!\n"
                   "n=0; while kill -0 $p 2>/dev/null; do n=$((n + 1))\n"
                   "  if ls -A | grep -q '^.hit.exr.*ambiance-tmp$'; then seen=$((seen + 1)); break; fi\n"
                   "done\n"
                   "kill -9 $p 2>/dev/null; wait $p 2>/dev/null\n"
                   "cmp -s hit.exr old || cmp -s hit.exr whole.exr || echo half a file\n"
                   "cp old hit.exr; rm -f .hit.exr.*; done; [ $seen -gt 0 ] && echo killed in mid-write");
    assert_string_equal(r.out, "killed in mid-write\n");
}

/* An interrupt in mid-write waits until the file is whole, and leaves nothing behind. */
static void interrupted_in_mid_write(void **state)
{
    (void)state;
    needs_scene();
    result r = run("seen=0; for i in 1 2; do rm -f int.exr\n"
                   "$P render $S --assets builtin --size 640x480 --quiet -o int.exr & p=$!\n"
                   "while kill -0 $p 2>/dev/null; do\n"
                   "  if ls -A | grep -q '^.int.exr.*ambiance-tmp$'; then seen=$((seen + 1)); break; fi\n"
                   "done\n"
                   "kill -TERM $p 2>/dev/null; wait $p 2>/dev/null\n"
                   "cmp -s int.exr whole.exr || echo not the whole file\n"
                   "done; ls -A | grep '^.int.exr'; [ $seen -gt 0 ] && echo interrupted in mid-write");
    assert_string_equal(r.out, "interrupted in mid-write\n");
}

static void same_bytes_whatever_the_machine_does(void **state)
{
    (void)state;
    needs_scene();
    const char *render = "$A render $S --assets builtin --time 3 --size 97x61 --aov all --quiet -o";
    char line[1024];
    snprintf(line, sizeof line, "%s base.exr --threads 1", render);
    succeeds(line);
    snprintf(line, sizeof line,
             "for t in 0 2 5; do %s t$t.exr --threads $t && cmp base.exr t$t.exr || exit 1; done\n"
             "for i in v2 v3 v4; do m=$(%s $i.exr --isa $i 2>&1) && cmp base.exr $i.exr || case \"$m\" in\n"
             "  *'this processor has'*) ;; *) echo \"$m\" >&2; exit 1 ;; esac; done",
             render, render);
    succeeds(line);
    snprintf(line, sizeof line, "%s other.exr --threads 3 && cmp base.exr other.exr && $A compare base.exr other.exr",
             render);
    succeeds(line);
}

static void files_and_formats(void **state)
{
    (void)state;
    needs_scene();
    succeeds("$A render $S --assets builtin --size 40x30 --quiet -o both.exr -o both.png");
    succeeds("$A info both.exr both.png");
    result r = run("$A info both.exr");
    assert_non_null(strstr(r.out, "OpenEXR, 40x30"));
    assert_non_null(strstr(r.out, "post        none"));
    r = run("$A info both.png");
    assert_non_null(strstr(r.out, "PNG, 40x30"));
    succeeds("$A render $S --assets builtin --size 40x30 --quiet --frame 7 -o f.####.png && test -f f.0007.png");
    succeeds("$A render $S --assets builtin --size 40x30 --quiet --half -o half.exr");
    fails(1, "$A compare --quiet both.exr half.exr; c=$?; echo 'ambiance: ' >&2; exit $c", "");
    succeeds("$A compare --tolerance 0.01 --max-ulp 8192 both.exr half.exr"); /* 13 bits of the fraction are gone */
    r = run("$A render $S --assets builtin --size 40x30 --json -o j.exr");
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.out, "\"color_sha256\": \""));
    /* An EXR is linear: a display pass in the chain changes nothing. */
    succeeds("$A render $S --assets builtin --size 40x30 --quiet --post display:exposure=3 -o d.exr\n"
             "$A compare both.exr d.exr");
    succeeds("$A render $S --assets builtin --size 40x30 -o shown.exr | grep -q '^shown.exr: '");
}

/* ---- compare and info -------------------------------------------------------------------------------------------- */

static void comparisons(void **state)
{
    (void)state;
    needs_scene();
    succeeds("$A render $S --assets builtin --size 40x30 --quiet -o one.exr -o one.png");
    succeeds("$A render $S --assets builtin --size 40x30 --time 2 --quiet -o two.exr -o two.png");
    succeeds("$A render $S --assets builtin --size 30x40 --quiet -o tall.exr");
    succeeds("$A compare one.exr one.exr");
    succeeds("$A compare one.png one.png --json");
    result r = run("$A compare one.exr two.exr");
    assert_int_equal(r.code, 1);
    assert_non_null(strstr(r.out, "different: "));
    assert_string_equal(r.err, "");
    r = run("$A compare --quiet one.exr two.exr");
    assert_int_equal(r.code, 1);
    assert_string_equal(r.out, "");
    r = run("$A compare --json one.exr two.exr");
    assert_int_equal(r.code, 1);
    assert_non_null(strstr(r.out, "\"same\": false"));
    r = run("$A compare one.exr tall.exr");
    assert_int_equal(r.code, 1);
    assert_string_equal(r.out, "different: sizes: 40x30 and 30x40\n");
    r = run("$A compare one.exr one.png"); /* an alpha that the PNG lacks */
    assert_int_equal(r.code, 1);
    r = run("$A compare --tolerance 1e9 one.exr two.exr");
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.out, "same within the tolerance"));
    r = run("$A compare one.exr two.exr --diff d.exr --quiet; $A compare one.exr two.exr --diff d.png --quiet\n"
            "$A info d.exr d.png");
    assert_int_equal(r.code, 0);
    fails(2, "$A compare one.exr", "compare: 1 files given; exactly two are expected");
    fails(2, "$A compare one.exr one.exr one.exr", "compare: 3 files given; exactly two are expected");
    fails(2, "$A compare --tolerance -1 one.exr one.exr", "--tolerance: -1; allowed: 0 or more");
    fails(2, "$A compare --tolerance x one.exr one.exr", "--tolerance: x; allowed: 0 or more");
    fails(2, "$A compare --max-ulp 1.5 one.exr one.exr", "--max-ulp: 1.5; allowed: ");
    fails(2, "$A compare --peak 0 one.exr one.exr", "--peak: 0; allowed: ");
    fails(2, "$A compare --layer colr one.exr one.exr", "unknown layer: colr; did you mean color?");
    fails(2, "$A compare --diff d.jpg one.exr one.exr", "output: d.jpg; allowed: names that end in .exr or .png");
    fails(3, "$A compare --diff missing/d.png one.exr one.exr", "output: missing/d.png; its folder: ");
    fails(3, "$A compare one.exr missing.exr", "missing.exr: No such file or directory");
}

static void bad_files(void **state)
{
    (void)state;
    fails(3, "$A info missing", "missing: No such file or directory");
    fails(3, "$A info /", "/: Is a directory");
    fails(3, "printf junk >junk; $A info junk", "junk: unknown kind of file; known: EXR, PNG");
    fails(3, ": >empty.exr; $A info empty.exr", "empty.exr: unknown kind of file");
    fails(3, ": >empty.obj; $A info empty.obj", "empty.obj");
    fails(3, "printf 'v 0 0 nan\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n' >nan.obj; $A info nan.obj", "nan.obj");
    fails(3, "printf 'ply\\nformat ascii 1.0\\nelement vertex 99999999\\n' >cut.ply; $A info cut.ply", "cut.ply");
    fails(3, "printf '\\211PNG\\r\\n\\032\\n' >cut.png; $A info cut.png", "cut.png");
    fails(3, "printf '\\377\\330\\377\\340' >cut.jpg; $A info cut.jpg", "cut.jpg");
    fails(3, "printf '#?RADIANCE\\n' >cut.hdr; $A info cut.hdr", "cut.hdr");
    fails(3, "printf '\\253KTX 11\\273\\r\\n\\032\\n' >cut.ktx; $A info cut.ktx", "cut.ktx");
    fails(3, "printf '\\166\\057\\061\\001' >cut.exr; $A info cut.exr", "cut.exr");
    fails(3, "$A compare nan.obj nan.obj", "nan.obj: a mesh file; a picture (EXR, PNG, JPEG, HDR) is expected");
    succeeds("printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n' >good.obj; $A info good.obj; $A info --json good.obj");
}

/* Every prefix length of a good file, in steps: always one line and exit code 3. */
static void truncated_files(void **state)
{
    (void)state;
    needs_scene();
    succeeds("$A render $S --assets builtin --size 24x16 --aov all --quiet -o cut.exr -o cut.png");
    result r = run("for f in cut.exr cut.png; do size=$(wc -c <$f); i=1; while [ $i -lt 24 ]; do\n"
                   "n=$((size * i / 24)); head -c $n $f >part.${f#cut.}; i=$((i + 1))\n"
                   "$A info part.${f#cut.} >.o 2>.e; c=$?\n"
                   "[ $c = 3 ] && [ ! -s .o ] && [ $(wc -l <.e) = 1 ] || echo $f $n $c; done; done");
    assert_string_equal(r.out, "");
}

/* ---- set-up ------------------------------------------------------------------------------------------------------ */

static char folder[] = "/tmp/ambiance-test-XXXXXX";

static int enter(void **state)
{
    (void)state;
    static char program[PATH_MAX], limited[PATH_MAX + 16], scene[64];
    const char *named = getenv("AMBIANCE");
    if (!realpath(named ? named : "build/ambiance", program) || !mkdtemp(folder) || chdir(folder) != 0)
        return -1;
    snprintf(limited, sizeof limited, "timeout 100 %s", program); /* a hang is a failure, not a wait */
    setenv("A", limited, 1);
    setenv("P", program, 1);
    unsetenv("AMBIANCE_ASSETS");
    unsetenv("AMBIANCE_PACK");
    result r = run("$A list --names | grep -x julia || $A list --names | head -n 1"); /* julia loads quickly */
    has_scene = r.code == 0 && sscanf(r.out, "%63s", scene) == 1;
    setenv("S", has_scene ? scene : "none", 1);
    return 0;
}

static int leave(void **state)
{
    (void)state;
    char line[128];
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return chdir("/") == 0 ? system(line) : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_version),
        cmocka_unit_test(options),
        cmocka_unit_test(listings),
        cmocka_unit_test(render_values),
        cmocka_unit_test(render_parameters),
        cmocka_unit_test(render_outputs),
        cmocka_unit_test(an_old_file_survives_a_failed_write),
        cmocka_unit_test(killed_in_mid_write),
        cmocka_unit_test(interrupted_in_mid_write),
        cmocka_unit_test(same_bytes_whatever_the_machine_does),
        cmocka_unit_test(files_and_formats),
        cmocka_unit_test(comparisons),
        cmocka_unit_test(bad_files),
        cmocka_unit_test(truncated_files),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
