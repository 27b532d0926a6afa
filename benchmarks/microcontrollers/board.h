/* board.h -- what programs for a microcontroller in an emulator, or for this machine, need besides C. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Writes a text. */
void board_print(const char *text);

/* Ends the program. */
void board_exit(int status);

/* Ticks of a clock that counts instructions; instructions of a tick are BOARD_TICK. */
uint32_t board_ticks(void);

/* Fills the free part of the stack with a pattern; the second counts the bytes of stack that functions which the
   same caller called have overwritten since. */
void board_mark_stack(void);
size_t board_used_stack(void);

#endif
