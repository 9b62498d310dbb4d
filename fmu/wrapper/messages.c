/* Refuse a call: errors are told whether or not logging is on. */
static fmi2Status refuse(const Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(m, fmi2Error, LOG_ERROR, format, arguments);
    va_end(arguments);
    return fmi2Error;
}

/* What was asked for cannot be computed here; the instance is as before. */
static fmi2Status discard(const Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(m, fmi2Discard, LOG_DISCARD, format, arguments);
    va_end(arguments);
    return fmi2Discard;
}

/* What the importer has to know even if it has switched warnings off. */
static void warn(const Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(m, fmi2Warning, LOG_WARNING, format, arguments);
    va_end(arguments);
}

/* A message of a category the importer can switch. */
static void note(const Instance *m, fmi2Status status, int category, const char *format, ...)
{
    va_list arguments;
    if (!(m->log_mask & (1u << category))) return;
    va_start(arguments, format);
    say(m, status, category, format, arguments);
    va_end(arguments);
}

static const char *mode_name(int mode)
{
    switch (mode) {
    case INSTANTIATED: return "instantiated";
    case INITIALIZATION: return "initialization mode";
    case EVENT: return "event mode";
    case CONTINUOUS_TIME: return "continuous-time mode";
    case STEP_COMPLETE: return "step complete";
    case STEP_FAILED: return "step failed";
    default: return "terminated";
    }
}

/* Whether a function may be called now; says why not. */
static int allowed(const Instance *m, int modes, const char *function)
{
    if (!m) return 0;
    if (m->s.mode & modes) return 1;
    refuse(m, "%s is not allowed in the mode \"%s\".", function, mode_name(m->s.mode));
    return 0;
}

/* The same for a function of one interface only. */
static int allowed_for(const Instance *m, fmi2Type type, int modes, const char *function)
{
    if (m && m->s.type != (int)type) {
        refuse(m, "%s belongs to %s, the instance to %s.", function,
               type == fmi2ModelExchange ? "model exchange" : "co-simulation",
               type == fmi2ModelExchange ? "co-simulation" : "model exchange");
        return 0;
    }
    return allowed(m, modes, function);
}

static int missing(const Instance *m, const void *pointer, size_t count, const char *function)
{
    if (pointer || count == 0) return 0;
    refuse(m, "%s: an argument is a null pointer.", function);
    return 1;
}
