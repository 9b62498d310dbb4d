/* The interfaces an instance may serve, and what its importer gave. */
typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Interface;

typedef struct {
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
    int event_mode;            /* co-simulation: the importer enters event mode */
} Callbacks;
