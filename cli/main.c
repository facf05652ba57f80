/* ambiance: the program. One file a subcommand; this one only finds it. */
#include "cli/cli.h"

#include "core/names.h"

#include <signal.h>
#include <string.h>

static const command *const commands[] = {&command_list, &command_render, &command_info, &command_compare};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

static const char *command_name(const void *user, int index)
{
    (void)user;
    return commands[index]->name;
}

static int print_help(void)
{
    printf("ambiance %s: renders the scenes of two graphics reports on the processor, the same bits everywhere\n\n"
           "usage: ambiance COMMAND [OPTION…]\n\n",
           amb_version());
    for (int i = 0; i < COMMAND_COUNT; i++)
        printf("  %-9s %s\n", commands[i]->name, commands[i]->about);
    printf("\n`ambiance COMMAND --help` explains one; `ambiance --version` prints the version.\n"
           "Exit codes: 0 done, 1 a comparison failed, 2 usage, 3 files. Errors are one line on standard error.\n");
    return EXIT_OK;
}

static bool asks_for_help(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return true;
    return false;
}

static int run(int argc, char **argv)
{
    char hint[320];
    if (argc < 2)
        return fail(EXIT_USAGE, "no command; %s; see `ambiance --help`",
                    amb_names_hint("", COMMAND_COUNT, command_name, NULL, hint, sizeof hint));
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0)
        return print_help();
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("ambiance %s\n", amb_version());
        return EXIT_OK;
    }
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(argv[1], commands[i]->name) == 0) {
            if (!asks_for_help(argc - 1, argv + 1))
                return commands[i]->run(argc - 1, argv + 1);
            fputs(commands[i]->help, stdout);
            return EXIT_OK;
        }
    return fail(EXIT_USAGE, "unknown command: %s; %s", argv[1],
                amb_names_hint(argv[1], COMMAND_COUNT, command_name, NULL, hint, sizeof hint));
}

int main(int argc, char **argv)
{
    static char buffer[1 << 18]; /* so that a full device is met by the flush at the end, which can say why */
    setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
    signal(SIGXFSZ, SIG_IGN); /* a file over the size limit is then a failed write, with its line, not a crash */
    return finish_output(run(argc, argv));
}
