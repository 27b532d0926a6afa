/* host.c -- board.h for this machine, so that a program prints the same here. */
#include <stdio.h>
#include <stdlib.h>

#include "board.h"

void board_print(const char *text)
{
    fputs(text, stdout);
}

void board_exit(int status)
{
    exit(status);
}

uint32_t board_ticks(void)
{
    return 0;
}

void board_mark_stack(void)
{
}

size_t board_used_stack(void)
{
    return 0;
}
