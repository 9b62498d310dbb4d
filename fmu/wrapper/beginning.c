/* How a run begins: at the given states, with all temperatures those of the room, or at rest. */

#define LONG_STEP 1e9          /* no machine is slower than this [s] */
#define AT_REST 1e-8           /* what a long step may still move, in nominals: the next one moves its square */

/* Where the machine settles at the present inputs, as the solver gets there by steps that grow as its error allows. NULL,
   or what prevented it. */
static const char *settle_down(Instance *m)
{
    State before = m->s;
    double x_new[AT_LEAST_1(NX)], z[AT_LEAST_1(NZ)], z_new[AT_LEAST_1(NZ)] = {0.0}, moved = INFINITY, h = 1.0;
    Effort effort = {0, 0, 0, 0};
    int worst = 0, i;
    const char *block;
    if ((block = unsolved(m)) != NULL) return block;
    memcpy(z, m->z, sizeof z);
    memset(m->s.slope, 0, sizeof m->s.slope);
    while (h > 0.0 && moved > AT_REST) {
        double size = fmin(h, LONG_STEP), error = trial(m, m->s.x, z, m->s.u, size, x_new, z_new, &worst);
        if (error <= 1.0) {
            for (i = 0, moved = 0.0; i < N_MODEL; i++)
                moved = fmax(moved, fabs(x_new[i] - m->s.x[i]) / model_nominal[FIRST_X + i] * (LONG_STEP / size));
            move_states(m, m->s.x, z, m->s.u, size, x_new, z_new);
            memcpy(m->s.x, x_new, sizeof m->s.x);
            memcpy(z, z_new, sizeof z);
        }
        h = next_size(&effort, error, size, size, 1.0);
    }
    memcpy(before.z, z, sizeof z);
    memcpy(before.x, m->s.x, N_MODEL * sizeof *before.x);
    memcpy(before.s, m->s.s, sizeof before.s);
    m->s = before;
    changed(m);
    return moved <= AT_REST ? unsolved(m) : model_names[FIRST_X + worst];
}

static fmi2Status begin(Instance *m)
{
    State before = m->s;
    const char *astray = NULL;
    int item = START < 0 ? 0 : (int)m->s.choice[START < 0 ? 0 : START], i;
    if (item == START_ROOM)
        for (i = 0; i < N_MODEL; i++)
            if (model_follows_room[i]) m->s.x[i] = *stored(m, ROOM_T);
    if (item == START_STEADY && (astray = settle_down(m)) != NULL) {
        m->s = before;
        warn(m, "fmi2ExitInitializationMode: there is no steady state at the initial inputs: %s does not settle. The run "
             "starts at the given states; check inputs and parameters, or choose another start.", astray);
        item = 0;
    }
    changed(m);
    m->s.states_touched |= item == START_ROOM || item == START_STEADY;
    return astray ? fmi2Warning : fmi2OK;
}
