const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
