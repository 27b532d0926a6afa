/* newlib.c -- what printf of newlib needs on a board: output by board.h, and memory behind the variables. */
#include <sys/stat.h>

#include "board.h"

extern char stack_bottom[]; /* end of the variables; the stack grows from the other end of the memory */
int _write(int file, const char *text, int length);
void *_sbrk(ptrdiff_t bytes);
int _close(int file);
int _fstat(int file, struct stat *found);
int _isatty(int file);
int _lseek(int file, int place, int from);
int _read(int file, char *text, int length);
int _getpid(void);
int _kill(int process, int number);
void _exit(int status);

int _write(int file, const char *text, int length)
{
    (void)file;
    for (int i = 0; i < length; ++i) {
        const char one[2] = {text[i], 0};
        board_print(one);
    }
    return length;
}

void *_sbrk(ptrdiff_t bytes)
{
    static char *end = stack_bottom;
    char *const before = end;
    end += bytes;
    return before;
}

int _close(int file)
{
    (void)file;
    return -1;
}

int _fstat(int file, struct stat *found)
{
    (void)file;
    found->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file)
{
    (void)file;
    return 1;
}

int _lseek(int file, int place, int from)
{
    (void)file;
    (void)place;
    (void)from;
    return 0;
}

int _read(int file, char *text, int length)
{
    (void)file;
    (void)text;
    (void)length;
    return 0;
}

int _getpid(void)
{
    return 1;
}

int _kill(int process, int number)
{
    (void)process;
    board_exit(number);
    return 0;
}

void _exit(int status)
{
    board_exit(status);
    for (;;) {
    }
}
