/* Saved FMU states: copies of State, and as bytes with a header that refuses foreign or damaged ones. */

#define SAVED_MAGIC "GHFMU2\0"
#define SAVED_VERSION 2u
#define SAVED_SIZE ((1 + N_SIDES) * sizeof(State))

typedef struct {
    char magic[8];
    unsigned version;
    unsigned size;
    unsigned model;
    unsigned checksum;
} SavedHeader;

/* FNV-1a */
static unsigned hash(const void *data, size_t size)
{
    const unsigned char *bytes = data;
    unsigned h = 2166136261u;
    size_t i;
    for (i = 0; i < size; i++) h = (h ^ bytes[i]) * 16777619u;
    return h;
}

static State *space_for_state(Instance *m, fmi2FMUstate *saved, const char *function)
{
    if (missing(m, saved, 1, function)) return NULL;
    if (!*saved) *saved = malloc(SAVED_SIZE);
    if (!*saved) refuse(m, "%s: out of memory.", function);
    return *saved;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *saved)
{
    Instance *m = c;
    State *copy;
    if (!allowed(m, ANY_MODE, "fmi2GetFMUstate")) return fmi2Error;
    if (!(copy = space_for_state(m, saved, "fmi2GetFMUstate"))) return fmi2Error;
    follow(m);
    keep(m, copy);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate saved)
{
    Instance *m = c;
    const State *copy = saved;
    if (!allowed(m, ANY_MODE, "fmi2SetFMUstate")) return fmi2Error;
    if (missing(m, saved, 1, "fmi2SetFMUstate")) return fmi2Error;
    if (copy->type != m->s.type)
        return refuse(m, "fmi2SetFMUstate: the state was saved by an instance of the other interface.");
    go_back(m, copy);
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *saved)
{
    if (!allowed(c, ANY_MODE, "fmi2FreeFMUstate")) return fmi2Error;
    if (!saved) return fmi2OK;
    free(*saved);
    *saved = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate saved, size_t *size)
{
    static const char f[] = "fmi2SerializedFMUstateSize";
    if (!allowed(c, ANY_MODE, f)) return fmi2Error;
    if (missing(c, saved, 1, f) || missing(c, size, 1, f)) return fmi2Error;
    *size = sizeof(SavedHeader) + SAVED_SIZE;
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate saved, fmi2Byte bytes[], size_t size)
{
    static const char f[] = "fmi2SerializeFMUstate";
    SavedHeader header = {SAVED_MAGIC, SAVED_VERSION, SAVED_SIZE, 0, 0};
    if (!allowed(c, ANY_MODE, f)) return fmi2Error;
    if (missing(c, saved, 1, f) || missing(c, bytes, 1, f)) return fmi2Error;
    if (size < sizeof header + SAVED_SIZE)
        return refuse(c, "%s: %lu bytes are too few, %lu are needed.", f, (unsigned long)size,
                      (unsigned long)(sizeof header + SAVED_SIZE));
    header.model = hash(MODEL_GUID, strlen(MODEL_GUID));
    header.checksum = hash(saved, SAVED_SIZE);
    memcpy(bytes, &header, sizeof header);
    memcpy(bytes + sizeof header, saved, SAVED_SIZE);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *saved)
{
    static const char f[] = "fmi2DeSerializeFMUstate";
    SavedHeader header;
    State *copy;
    if (!allowed(c, ANY_MODE, f)) return fmi2Error;
    if (missing(c, bytes, 1, f)) return fmi2Error;
    if (size < sizeof header + SAVED_SIZE) return refuse(c, "%s: the saved state is too short.", f);
    memcpy(&header, bytes, sizeof header);
    if (memcmp(header.magic, SAVED_MAGIC, sizeof header.magic) != 0 || header.version != SAVED_VERSION)
        return refuse(c, "%s: these bytes are no saved state of this version.", f);
    if (header.model != hash(MODEL_GUID, strlen(MODEL_GUID)) || header.size != SAVED_SIZE)
        return refuse(c, "%s: the state was saved by another FMU.", f);
    if (header.checksum != hash(bytes + sizeof header, SAVED_SIZE))
        return refuse(c, "%s: the saved state is damaged.", f);
    if (!(copy = space_for_state(c, saved, f))) return fmi2Error;
    memcpy(copy, bytes + sizeof header, SAVED_SIZE);
    return fmi2OK;
}
