/* Messages to the importer. */

static const char *const category_names[N_CATEGORIES] = {
    "logStatusError", "logStatusDiscard", "logStatusWarning", "logSolver"};

static void say(const Instance *m, fmi3Status status, int category, const char *format, va_list arguments)
{
    char text[1024], escaped[2048], *to = escaped;
    const char *c;
    if (!m->callbacks.logger) return;
    vsnprintf(text, sizeof text, format, arguments);
    for (c = text; *c; *to++ = *c++)
        if (*c == '#') *to++ = '#'; /* one alone would begin a value reference */
    *to = '\0';
    m->callbacks.logger(m->callbacks.environment, status, category_names[category], escaped);
}
