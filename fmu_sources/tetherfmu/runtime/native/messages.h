/* Sentences with {names} to fill in, and the status of the call that logs them. */
#ifndef MESSAGES_H
#define MESSAGES_H

#include <stdbool.h>
#include <stddef.h>

typedef struct Instance Instance;
typedef int Status; /* not an enumeration: FMI 2 and FMI 3 each have their own, with these numbers */
enum { OK, WARNING, DISCARD, ERROR }; /* WARNING is for messages only: no call returns it */
enum { LONGEST_TEXT = 1024 };

typedef struct {
    const char *key, *text;
    double number;
    bool whole;
} Fact;

Fact real(const char *key, double number);
Fact whole(const char *key, double number);
Fact word(const char *key, const char *text);
void fill_in(char *text, size_t room, const char *sentence, const Fact *facts);
void rename_in(char *text, size_t room, const char *sentence, const char *const *words);
Status say(Instance *instance, Status status, const char *sentence, const Fact *facts);
Status refuse_null(Instance *instance, const char *argument);
#define FACTS(...) ((const Fact[]){__VA_ARGS__, {0}}) /* an entry without a key ends the list */

#endif
