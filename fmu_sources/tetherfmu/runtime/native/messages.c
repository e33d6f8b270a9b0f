/* Sentences with {names} or {names:format} that are filled in, numbers as Python writes them. */
#include "messages.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "finite.h"
#include "instance.h"

enum { STANDARD_SNPRINTF = 2 };   /* option of the Universal C Runtime */
enum { DIGITS_OF_A_DOUBLE = 17 }; /* that identify it uniquely */
enum { FIRST_FIXED = -4, FIRST_SCIENTIFIC = 16 }; /* range of decimal exponents that Python does not write */
enum { LONGEST_SCIENTIFIC = 32, LONGEST_NUMBER = 512 }; /* texts of a double, with and without an exponent */
enum { LONGEST_FORMAT = 16 };                           /* of formats in the sentences */

/* `snprintf`, which has another name in the Universal C Runtime of Windows. */
static int print(char *text, size_t room, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
#ifdef _WIN32
    int length = __stdio_common_vsprintf(STANDARD_SNPRINTF, text, room, format, NULL, arguments);
#else
    int length = vsnprintf(text, room, format, arguments);
#endif
    va_end(arguments);
    return length;
}

Fact real(const char *key, double number)
{
    return (Fact){key, NULL, number, false};
}

Fact whole(const char *key, double number)
{
    return (Fact){key, NULL, number, true};
}

Fact word(const char *key, const char *text)
{
    return (Fact){key, text, 0.0, false};
}

typedef struct {
    char *next, *last;
} Writer;

static void put(Writer *writer, char character)
{
    if (writer->next < writer->last) *writer->next++ = character;
}

static void put_text(Writer *writer, const char *text)
{
    while (*text) put(writer, *text++);
}

/* Shortest decimal digits that read back to a positive finite number; returns its decimal exponent. */
static int shortest_digits(double number, char *digits)
{
    char text[LONGEST_SCIENTIFIC];
    for (int precision = 0; precision < DIGITS_OF_A_DOUBLE; precision++) {
        print(text, sizeof text, "%.*e", precision, number);
        if (strtod(text, NULL) == number) break;
    }
    const char *exponent = strchr(text, 'e');
    for (const char *each = text; each < exponent; each++)
        if (*each >= '0' && *each <= '9') *digits++ = *each; /* whatever the decimal point of the locale is */
    *digits = '\0';
    return (int)strtol(exponent + 1, NULL, 10);
}

/* A number as Python's `repr` writes it. */
static void put_real(Writer *writer, double number)
{
    char digits[LONGEST_SCIENTIFIC], power[LONGEST_SCIENTIFIC];
    if (number != number) {
        put_text(writer, "nan");
        return;
    }
    if (copysign(1.0, number) < 0.0) put(writer, '-');
    if (!is_finite(number)) {
        put_text(writer, "inf");
        return;
    }
    int exponent = shortest_digits(fabs(number), digits), count = (int)strlen(digits);
    bool fixed = FIRST_FIXED <= exponent && exponent < FIRST_SCIENTIFIC;
    int before_point = fixed ? exponent + 1 : 1;
    if (before_point < 1) put(writer, '0');
    for (int i = 0; i < before_point; i++) put(writer, i < count ? digits[i] : '0');
    if (fixed || count > 1) put(writer, '.');
    for (int i = before_point; i < 0; i++) put(writer, '0');
    put_text(writer, before_point >= count ? (fixed ? "0" : "") : digits + (before_point > 0 ? before_point : 0));
    if (!fixed) {
        print(power, sizeof power, "e%+03d", exponent);
        put_text(writer, power);
    }
}

/* A number in a printf format, with a decimal point in any locale. */
static void put_formatted(Writer *writer, const char *format, double number)
{
    char text[LONGEST_NUMBER];
    print(text, sizeof text, format, number);
    for (char *each = text; *each; each++) put(writer, *each == ',' ? '.' : *each);
}

static void put_fact(Writer *writer, const Fact *fact, const char *format, size_t length)
{
    char pattern[LONGEST_FORMAT] = "%";
    if (fact->text) {
        put_text(writer, fact->text);
    } else if (length > 0 && length < sizeof pattern - 1) {
        memcpy(pattern + 1, format, length);
        put_formatted(writer, pattern, fact->number);
    } else if (fact->whole) {
        put_formatted(writer, "%.0f", fact->number);
    } else {
        put_real(writer, fact->number);
    }
}

/* Write a sentence into `text`, truncated if necessary; `facts` ends with one without a key. */
void fill_in(char *text, size_t room, const char *sentence, const Fact *facts)
{
    Writer writer = {text, text + room - 1};
    while (*sentence) {
        if (*sentence != '{') {
            put(&writer, *sentence++);
            continue;
        }
        size_t length = strcspn(++sentence, "}"), key = strcspn(sentence, ":}");
        const Fact *fact = facts;
        while (fact && fact->key && (strlen(fact->key) != key || memcmp(fact->key, sentence, key))) fact++;
        if (fact && fact->key) put_fact(&writer, fact, sentence + key + 1, key < length ? length - key - 1 : 0);
        sentence += length + (sentence[length] == '}');
    }
    *writer.next = '\0';
}

/* Whether a letter continues a name: letters without accents, digits and `_`, as `\w` of regular expressions in ASCII. */
static bool is_of_a_name(char letter)
{
    bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
    return is_letter || (letter >= '0' && letter <= '9') || letter == '_';
}

/* Write a sentence into `text` with other words: pairs of texts, an empty one at their end; the first that fits counts.
 * Names with a dot stay. */
void rename_in(char *text, size_t room, const char *sentence, const char *const *words)
{
    Writer writer = {text, text + room - 1};
    const char *end = sentence + strlen(sentence);
    char before = ' ';
    while (sentence < end) {
        const char *const *pair = words;
        bool is_begun = before == '.' || is_of_a_name(before);
        while (**pair && (is_begun || strlen(*pair) > (size_t)(end - sentence) || memcmp(sentence, *pair, strlen(*pair)))) pair += 2;
        if (**pair) put_text(&writer, pair[1]);
        else put(&writer, *sentence);
        sentence += **pair ? strlen(*pair) : 1;
        before = sentence[-1];
    }
    *writer.next = '\0';
}

/* Write the first refusal to stderr if the importer has not enabled logging, and may show nothing. */
static void write_first(Instance *instance, const char *text)
{
    if (instance->is_logging || instance->has_written) return;
    char line[LONGEST_TEXT];
    print(line, sizeof line, "%s: %s\n", instance->name, text);
    fputs(line, stderr);
    instance->has_written = true;
}

/* Pass a sentence to the importer, with the name of the call in front; returns the status of the call, OK for a warning. */
Status say(Instance *instance, Status status, const char *sentence, const Fact *facts)
{
    char text[LONGEST_TEXT];
    size_t length = (size_t)print(text, sizeof text, "%s: ", instance->call); /* the name of an FMI function is short */
    fill_in(text + length, sizeof text - length, sentence, facts);
    if (instance->importer_log) instance->log(instance, status, text);
    if (status == WARNING) return OK;
    write_first(instance, text);
    return status;
}

/* Refuse a call that lacks an argument. */
Status refuse_null(Instance *instance, const char *argument)
{
    return say(instance, ERROR, IS_NULL, FACTS(word("argument", argument)));
}
