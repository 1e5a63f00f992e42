/* code.c - nothing: the linker takes from the library what one call needs. SPDX-License-Identifier: MIT */
typedef int code_is_empty;
