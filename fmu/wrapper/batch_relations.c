/* Which rows have parameters that fit each other: the place of the first relation that does not hold, -1 where all do. */

BATCH_EXPORT int batch_relations(int64_t n, const double *p, int64_t p_stride, int32_t *broken)
{
    double value[N_RELATIONS];
    int64_t row;
    int32_t i;
    for (row = 0; row < n; row++) {
        model_relations_of(p + row * p_stride, value);
        for (i = 0; i < N_RELATIONS; i++)
            if (!(value[i] >= model_relation_low[i] && value[i] <= model_relation_high[i])) break;
        broken[row] = i < N_RELATIONS ? i : -1;
    }
    return 1;
}
