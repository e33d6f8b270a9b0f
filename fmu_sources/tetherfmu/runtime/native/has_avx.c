/* Whether the kernels may use AVX: the processor has it, and the system saves its registers.

Source: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, "Detection of Intel AVX Instructions". */
#ifdef __x86_64__

#include <cpuid.h>

enum { NOT_ASKED, NO, YES };
enum { REGISTERS_OF_SSE_AND_AVX = 6 }; /* bits of extended control register 0 */

static int ask(void)
{
    unsigned eax, ebx, ecx, edx, saved = 0;
    __cpuid(1, eax, ebx, ecx, edx);
    if ((ecx & bit_OSXSAVE) && (ecx & bit_AVX)) {
        __asm__("xgetbv" : "=a"(saved), "=d"(edx) : "c"(0));
    }
    return (saved & REGISTERS_OF_SSE_AND_AVX) == REGISTERS_OF_SSE_AND_AVX ? YES : NO;
}

/* Asks once, since asking takes longer than a step of a straight tether; threads that ask at once find the same. */
int has_avx(void)
{
    static int known = NOT_ASKED;
    int answer = __atomic_load_n(&known, __ATOMIC_RELAXED);
    if (answer == NOT_ASKED) {
        answer = ask();
        __atomic_store_n(&known, answer, __ATOMIC_RELAXED);
    }
    return answer == YES;
}

#endif
