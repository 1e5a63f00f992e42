// As much of Arduino as the example sketch needs, on a PC; Serial keeps what it is given.
#include <cstdio>
#include <string>

enum { A0, A1 };
static std::string serial_text;

static int analogRead(int pin) { return pin == A0 ? 600 : 400; }
static void delay(unsigned long) {}

static struct {
    void begin(unsigned long) {}
    void print(char c) { serial_text += c; }
    void print(double x, int digits) {
        char text[32];
        std::snprintf(text, sizeof text, "%.*f", digits, x);
        serial_text += text;
    }
    void println(double x, int digits) {
        print(x, digits);
        print('\n');
    }
    void println(const char *text) {
        serial_text += text;
        print('\n');
    }
} Serial;
