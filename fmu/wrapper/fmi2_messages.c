/* Messages to the importer: pre-formatted, so that no importer has to read a format string. */

static const char *const category_names[N_CATEGORIES] = {
    "logStatusError", "logStatusDiscard", "logStatusWarning", "logSolver"};

static void say(const Instance *m, fmi2Status status, int category, const char *format, va_list arguments)
{
    char text[1024];
    char *c;
    if (!m->callbacks.logger) return;
    vsnprintf(text, sizeof text, format, arguments);
    for (c = text; *c; c++)
        if (*c == '%') *c = '_'; /* importers pass the text to printf */
    m->callbacks.logger(m->callbacks.componentEnvironment, m->name, status, category_names[category], text);
}
