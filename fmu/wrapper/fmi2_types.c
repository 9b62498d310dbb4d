#define NO_VARIABLES(TYPE) \
    fmi2Status fmi2Get##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##TYPE value[]) \
    { \
        (void)r, (void)value; \
        return no_variables(c, n, GETTABLE, "fmi2Get" #TYPE); \
    } \
    fmi2Status fmi2Set##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##TYPE value[]) \
    { \
        (void)r, (void)value; \
        return no_variables(c, n, SETTABLE & ~CONTINUOUS_TIME, "fmi2Set" #TYPE); \
    }

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer value[])
{
    GET_WHOLE(WHOLE_NUMBER | ENUMERATION, "fmi2GetInteger")
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer value[])
{
    SET_WHOLE(WHOLE_NUMBER | ENUMERATION, "fmi2SetInteger")
}

NO_VARIABLES(Boolean)
NO_VARIABLES(String)
