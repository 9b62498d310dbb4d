/* Functions both interfaces share: life cycle, logging, values. */

#define GETTABLE ANY_MODE
#define SETTABLE (INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS_TIME | STEP_COMPLETE | STEP_FAILED)
