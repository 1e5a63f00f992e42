/* quiet_check.h - Check without a note of every assertion that holds. The note is a system call, and these
   tests make millions of assertions: some took fifty times as long. Of a test that crashes Check now tells
   the name alone, not the line. */
#ifndef QUIET_CHECK_H
#define QUIET_CHECK_H

#include <check.h>

#define _mark_point(file, line) ((void)0)

#endif
