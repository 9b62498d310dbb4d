/* What FMI 3.0 has and this FMU has not: other types, clocks, structural parameters. An importer may ask for nothing of
   them, and is refused when it asks for something. */

#define NO_VARIABLES(TYPE) \
    fmi3Status fmi3Get##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##TYPE a[], size_t n_values) \
    { \
        (void)r, (void)a; \
        return no_variables(c, n + n_values, GETTABLE, "fmi3Get" #TYPE); \
    } \
    fmi3Status fmi3Set##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##TYPE a[], \
                             size_t n_values) \
    { \
        (void)r, (void)a; \
        return no_variables(c, n + n_values, SETTABLE & ~CONTINUOUS_TIME, "fmi3Set" #TYPE); \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary a[],
                         size_t n_values)
{
    (void)r, (void)sizes, (void)a;
    return no_variables(c, n + n_values, GETTABLE, "fmi3GetBinary");
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t sizes[],
                         const fmi3Binary a[], size_t n_values)
{
    (void)r, (void)sizes, (void)a;
    return no_variables(c, n + n_values, SETTABLE & ~CONTINUOUS_TIME, "fmi3SetBinary");
}

#define NO_CLOCKS(NAME, ARRAYS, UNUSED) \
    fmi3Status fmi3##NAME(fmi3Instance c, const fmi3ValueReference r[], size_t n, ARRAYS) \
    { \
        (void)r, UNUSED; \
        return no_variables(c, n, ANY_MODE, "fmi3" #NAME); \
    }
#define TWO(A, B) A, B

NO_CLOCKS(GetClock, fmi3Clock a[], (void)a)
NO_CLOCKS(SetClock, const fmi3Clock a[], (void)a)
NO_CLOCKS(GetIntervalDecimal, TWO(fmi3Float64 a[], fmi3IntervalQualifier b[]), TWO((void)a, (void)b))
NO_CLOCKS(SetIntervalDecimal, const fmi3Float64 a[], (void)a)
NO_CLOCKS(GetIntervalFraction, TWO(fmi3UInt64 a[], TWO(fmi3UInt64 b[], fmi3IntervalQualifier d[])),
          TWO((void)a, TWO((void)b, (void)d)))
NO_CLOCKS(SetIntervalFraction, TWO(const fmi3UInt64 a[], const fmi3UInt64 b[]), TWO((void)a, (void)b))
NO_CLOCKS(GetShiftDecimal, fmi3Float64 a[], (void)a)
NO_CLOCKS(SetShiftDecimal, const fmi3Float64 a[], (void)a)
NO_CLOCKS(GetShiftFraction, TWO(fmi3UInt64 a[], fmi3UInt64 b[]), TWO((void)a, (void)b))
NO_CLOCKS(SetShiftFraction, TWO(const fmi3UInt64 a[], const fmi3UInt64 b[]), TWO((void)a, (void)b))

static fmi3Status absent(fmi3Instance c, const char *function, const char *what)
{
    return c ? refuse(c, "%s: this FMU has no %s.", function, what) : fmi3Error;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return absent(c, "fmi3EnterConfigurationMode", "structural parameters");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return absent(c, "fmi3ExitConfigurationMode", "structural parameters");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return absent(c, "fmi3EvaluateDiscreteStates", "discrete states");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return absent(c, "fmi3ActivateModelPartition", "scheduled execution");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference r, size_t *n)
{
    (void)r, (void)n;
    return absent(c, "fmi3GetNumberOfVariableDependencies", "arrays: see the model structure");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference r, size_t elements[],
                                       fmi3ValueReference known[], size_t elements_of_known[],
                                       fmi3DependencyKind kinds[], size_t n)
{
    (void)r, (void)elements, (void)known, (void)elements_of_known, (void)kinds, (void)n;
    return absent(c, "fmi3GetVariableDependencies", "arrays: see the model structure");
}
