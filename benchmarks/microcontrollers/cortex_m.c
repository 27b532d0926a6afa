/* cortex_m.c -- board.h for a Cortex-M in QEMU: vectors, floating-point unit, semihosting, SysTick. */
#include "board.h"

extern uint32_t stack_top[], stack_bottom[];
int main(void);
void reset(void);
static void fault(void);

struct vectors {
    uint32_t *stack;
    void (*handlers[15])(void);
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    stack_top, {reset, fault, fault, fault, fault, fault, fault},
};

enum { WRITE0 = 0x04, EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026, PATTERN = 0x5a5a5a5a };

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define SYSTICK_CONTROL REGISTER(0xe000e010u)
#define SYSTICK_RELOAD REGISTER(0xe000e014u)
#define SYSTICK_VALUE REGISTER(0xe000e018u)
#define COPROCESSORS REGISTER(0xe000ed88u)

static void semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void reset(void)
{
#if defined(__ARM_FP)
    COPROCESSORS |= 0xf00000u; /* full access to the floating-point unit */
    __asm__ volatile("dsb\n\tisb" : : : "memory");
#endif
    SYSTICK_RELOAD = 0xffffffu;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5; /* on, by the clock of the processor, without interrupts */
    board_exit(main());
}

static void fault(void)
{
    board_print("fault\n");
    board_exit(255);
}

void board_print(const char *text)
{
    semihosting(WRITE0, text);
}

void board_exit(int status)
{
    const uint32_t arguments[2] = {APPLICATION_EXIT, (uint32_t)status};
    semihosting(EXIT_EXTENDED, arguments);
    for (;;) {
    }
}

uint32_t board_ticks(void)
{
    return 0xffffffu - SYSTICK_VALUE;
}

static uint32_t *caller; /* stack pointer of the function that marked the stack */

__attribute__((noinline)) void board_mark_stack(void)
{
    uint32_t *end;
    __asm__ volatile("mov %0, sp" : "=r"(end));
    caller = __builtin_dwarf_cfa();
    for (volatile uint32_t *place = stack_bottom; place < end; ++place) {
        *place = PATTERN;
    }
}

__attribute__((noinline)) size_t board_used_stack(void)
{
    const uint32_t *place = stack_bottom;
    while (place < caller && *(const volatile uint32_t *)place == PATTERN) {
        ++place;
    }
    return (size_t)(caller - place)*sizeof *place;
}

/* The functions of the C library that programs for boards call. */
int puts(const char *text);

int puts(const char *text)
{
    board_print(text);
    board_print("\n");
    return 0;
}
