/* Choices: an item gives parameters values of its own; a parameter that has been changed keeps its own value. */

static void use_choices(State *s)
{
    int k;
    memcpy(s->p, s->own, sizeof s->p);
    for (k = 0; k < N_PRESETS; k++) {
        int i = model_preset_parameter[k];
        if (s->choice[model_preset_choice[k]] == model_preset_item[k] && s->own[i] == model_start[FIRST_P + i])
            s->p[i] = model_preset_value[k];
    }
}
