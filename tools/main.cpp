#include <rayloom/tools/cli.h>

int main(int argc, char** argv) { return rayloom::tools::run_command_line(argc, argv); }
