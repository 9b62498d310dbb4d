/* What a library of Windows needs of a C compiler's run-time library. With it here, the library needs the system's own
   C library alone, and nobody has to build that of the compiler, which takes minutes. */
#include <math.h>
#include <stdarg.h>

int __stdio_common_vsprintf(unsigned long long, char *, size_t, const char *, void *, va_list);

int vsnprintf(char *text, size_t size, const char *format, va_list rest)
{
    int length = __stdio_common_vsprintf(2 /* as the standard of C says */, text, size, format, (void *)0, rest);
    return length < 0 ? -1 : length;
}

int snprintf(char *text, size_t size, const char *format, ...)
{
    va_list rest;
    int length;
    va_start(rest, format);
    length = vsnprintf(text, size, format, rest);
    va_end(rest);
    return length;
}

int __fpclassify(double x)
{
    return __builtin_fpclassify(FP_NAN, FP_INFINITE, FP_NORMAL, FP_SUBNORMAL, FP_ZERO, x);
}

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved)
{
    (void)library, (void)reason, (void)reserved;
    return 1;
}

int __isnan(double x)
{
    return __builtin_isnan(x);
}

int __signbit(double x)
{
    return __builtin_signbit(x) != 0;
}

/* Touches every page of a large frame on the way down, as Windows asks for. */
#ifdef _WIN64
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    pushq %rcx\n"
        "    pushq %rax\n"
        "    leaq 24(%rsp), %rcx\n"
        "1:  cmpq $4096, %rax\n"
        "    jb 2f\n"
        "    subq $4096, %rcx\n"
        "    testq %rcx, (%rcx)\n"
        "    subq $4096, %rax\n"
        "    jmp 1b\n"
        "2:  subq %rax, %rcx\n"
        "    testq %rcx, (%rcx)\n"
        "    popq %rax\n"
        "    popq %rcx\n"
        "    ret\n");
#else
__asm__(".globl __alloca\n"
        "__alloca:\n"
        "    pushl %ecx\n"
        "    leal 8(%esp), %ecx\n"
        "1:  cmpl $4096, %eax\n"
        "    jb 2f\n"
        "    subl $4096, %ecx\n"
        "    testl %ecx, (%ecx)\n"
        "    subl $4096, %eax\n"
        "    jmp 1b\n"
        "2:  subl %eax, %ecx\n"
        "    testl %ecx, (%ecx)\n"
        "    leal 4(%esp), %eax\n"
        "    movl %ecx, %esp\n"
        "    movl -4(%eax), %ecx\n"
        "    movl (%eax), %eax\n"
        "    pushl %eax\n"
        "    ret\n");
#endif
