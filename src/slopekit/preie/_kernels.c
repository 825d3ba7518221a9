/* The loops that take the time of many blocks, compiled: what bed.py, patterns.py and stiffness.py do with NumPy.

   Optional, and one file for every Python from 3.11 on (limited API). Arrays come as buffers, C order, float64, int64
   and bool, and are checked for their size only: kernels.py and its callers see to the rest. BLAS and LAPACK are those
   that SciPy has (`bind`). What is done and why stands in the Python that each function replaces. */

#define Py_LIMITED_API 0x030B0000
#include <Python.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef int64_t whole;
#define INLINE static inline __attribute__((always_inline))
#define MOST 16 /* arrays of one object */

/* -- arrays ------------------------------------------------------------------------------------------------------- */

/* The data of an array of `count` items (< 0: as many as there are), NULL and an exception where it has another size. */
static void *array_of(PyObject *from, whole count, whole item, int writable, Py_buffer *view)
{
    if (PyObject_GetBuffer(from, view, writable ? PyBUF_WRITABLE : PyBUF_SIMPLE) < 0) return NULL;
    if (count >= 0 && view->len != count * item) {
        PyErr_Format(PyExc_ValueError, "an array of %zd bytes where %zd belong", view->len, (Py_ssize_t)(count * item));
        PyBuffer_Release(view);
        return NULL;
    }
    return view->buf;
}

/* An object of ours, and the arrays and objects that it keeps. */
typedef struct {
    int arrays;
    Py_buffer views[MOST];
    PyObject *other;
} Kept;

static void released(Kept *kept)
{
    for (int i = 0; i < kept->arrays; i++) PyBuffer_Release(&kept->views[i]);
    kept->arrays = 0;
    Py_CLEAR(kept->other);
}

/* Takes the next array; NULL for None. `*failed` stays set once something went wrong. */
static void *taken(Kept *kept, PyObject *from, whole count, whole item, int writable, int *failed)
{
    if (*failed || from == Py_None) return NULL;
    void *data = array_of(from, count, item, writable, &kept->views[kept->arrays]);
    if (data) kept->arrays++;
    else *failed = 1;
    return data;
}

static int enough(Py_ssize_t given, Py_ssize_t wanted)
{
    if (given == wanted) return 1;
    PyErr_Format(PyExc_TypeError, "%zd arguments where %zd belong", given, wanted);
    return 0;
}

#define FLOATS(from, count) (double *)taken(kept, from, count, 8, 0, &failed)
#define WHOLES(from, count) (whole *)taken(kept, from, count, 8, 0, &failed)
#define BOOLS(from, count) (char *)taken(kept, from, count, 1, 0, &failed)
#define OUT(from, count) (double *)taken(kept, from, count, 8, 1, &failed)
#define OUT_BOOLS(from, count) (char *)taken(kept, from, count, 1, 1, &failed)

/* -- contacts ----------------------------------------------------------------------------------------------------- */

typedef struct {
    Kept kept;
    int u, t; /* 6 and 2, or 3 and 1 in a section */
    whole blocks, contacts, groups, pairs;
    const whole *plus, *minus, *first_group, *first_pair; /* groups of a contact, pairs of a group: (k + 1), (g + 1) */
    const double *rows, *slips, *plus_motion, *minus_motion;
} Contacts;

typedef struct {
    Kept kept;
    const Contacts *of;
    const double *area, *spring, *cohesion, *friction;
    const double *held; /* relative motion of each contact by blocks that are held where they are, or NULL */
    const char *bolted;
} Law;

static const char CONTACTS[] = "slopekit.contacts", LAW[] = "slopekit.law", PLAN[] = "slopekit.plan",
                  FRONTS[] = "slopekit.fronts";

static void freed(PyObject *capsule)
{
    Kept *kept = PyCapsule_GetPointer(capsule, PyCapsule_GetName(capsule));
    free(PyCapsule_GetContext(capsule));
    released(kept);
    free(kept);
}

static PyObject *object_of(void *made, const char *name, int failed)
{
    PyObject *capsule = failed ? NULL : PyCapsule_New(made, name, freed);
    if (capsule) return capsule;
    released((Kept *)made);
    free(made);
    return NULL;
}

/* contacts(u, t, blocks, contacts, groups, pairs, plus, minus, first_group, first_pair, rows, slips, plus_motion,
            minus_motion) */
static PyObject *contacts(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 14)) return NULL;
    Contacts *c = calloc(1, sizeof *c);
    if (!c) return PyErr_NoMemory();
    Kept *kept = &c->kept;
    c->u = (int)PyLong_AsLong(a[0]), c->t = (int)PyLong_AsLong(a[1]), c->blocks = PyLong_AsLongLong(a[2]);
    whole k = c->contacts = PyLong_AsLongLong(a[3]), g = c->groups = PyLong_AsLongLong(a[4]);
    whole m = c->pairs = PyLong_AsLongLong(a[5]), u = c->u, half = c->u / 2;
    int failed = PyErr_Occurred() != NULL;
    if (!failed && !(c->u == 6 && c->t == 2) && !(c->u == 3 && c->t == 1)) {
        PyErr_SetString(PyExc_ValueError, "neither space nor a section");
        failed = 1;
    }
    c->plus = WHOLES(a[6], k), c->minus = WHOLES(a[7], k);
    c->first_group = WHOLES(a[8], k + 1), c->first_pair = WHOLES(a[9], g + 1);
    c->rows = FLOATS(a[10], m * (u == 6 ? 3 : 2)), c->slips = FLOATS(a[11], g * c->t * half);
    c->plus_motion = FLOATS(a[12], k * u * u), c->minus_motion = FLOATS(a[13], k * u * u);
    return object_of(c, CONTACTS, failed);
}

/* law(contacts, area, spring, cohesion, friction, bolted or None, motions of contacts by blocks that are held or None) */
static PyObject *law(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 7)) return NULL;
    const Contacts *c = PyCapsule_GetPointer(a[0], CONTACTS);
    if (!c) return NULL;
    Law *l = calloc(1, sizeof *l);
    if (!l) return PyErr_NoMemory();
    Kept *kept = &l->kept;
    int failed = 0;
    l->of = c, kept->other = Py_NewRef(a[0]);
    l->area = FLOATS(a[1], c->pairs), l->spring = FLOATS(a[2], c->groups), l->cohesion = FLOATS(a[3], c->groups);
    l->friction = FLOATS(a[4], c->groups), l->bolted = BOOLS(a[5], c->groups);
    l->held = FLOATS(a[6], c->contacts * c->u);
    return object_of(l, LAW, failed);
}

/* Where the numbers that an opening and a slip are read off stand in the motion of a contact (patterns.py). */
static const int NORMAL6[] = {0, 4, 5}, SLIP6[] = {1, 2, 3}, NORMAL3[] = {0, 2}, SLIP3[] = {1};

/* The relative motion of contact k, J x. */
INLINE void motion_of(const Contacts *c, whole k, const double *x, double *r, const int u)
{
    const double *p = c->plus_motion + k * u * u, *q = c->minus_motion + k * u * u;
    const double *xp = x + c->plus[k] * u, *xq = c->minus[k] < 0 ? NULL : x + c->minus[k] * u;
    for (int i = 0; i < u; i++) {
        double sum = 0.0;
        for (int j = 0; j < u; j++) sum += p[i * u + j] * xp[j];
        if (xq)
            for (int j = 0; j < u; j++) sum += q[i * u + j] * xq[j];
        r[i] = sum;
    }
}

/* Adds the force f of contact k to those on its blocks, J^T f. */
INLINE void push(const Contacts *c, whole k, const double *f, double *out, const int u)
{
    const double *p = c->plus_motion + k * u * u, *q = c->minus_motion + k * u * u;
    double *op = out + c->plus[k] * u;
    for (int j = 0; j < u; j++)
        for (int i = 0; i < u; i++) op[i] += p[j * u + i] * f[j];
    if (c->minus[k] < 0) return;
    double *oq = out + c->minus[k] * u;
    for (int j = 0; j < u; j++)
        for (int i = 0; i < u; i++) oq[i] += q[j * u + i] * f[j];
}

INLINE double dot(const double *a, const double *b, const int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* -- forces (Bed.forces) and viscous forces (Bed.viscous) ---------------------------------------------------------- */

typedef struct {
    const double *frozen;
    double *normal, *friction, *strength, *direction, *slip, *unbalanced;
    char *touching, *slips;
    double highest, pressed, longest; /* largest normal force, |N| of pairs that need not touch, elastic shear force */
} Carried;

INLINE void forces_in(const Law *l, const double *x, double reduction, Carried *to, const int u, const int t)
{
    const Contacts *c = l->of;
    const int *in = u == 6 ? NORMAL6 : NORMAL3, *is = u == 6 ? SLIP6 : SLIP3, nn = u == 6 ? 3 : 2, ns = u == 6 ? 3 : 1;
    double highest = 0.0, pressed = 0.0, longest = 0.0;
    for (whole k = 0; k < c->contacts; k++) {
        double r[6], opens[3], slides[3], f[6] = {0.0};
        motion_of(c, k, x, r, u);
        if (l->held)
            for (int i = 0; i < u; i++) r[i] += l->held[k * u + i];
        for (int i = 0; i < nn; i++) opens[i] = r[in[i]];
        for (int i = 0; i < ns; i++) slides[i] = r[is[i]];
        for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) {
            double sum = 0.0, e[2], square = 0.0;
            for (whole m = c->first_pair[g]; m < c->first_pair[g + 1]; m++) {
                const double *row = c->rows + m * nn;
                double opening = dot(row, opens, nn), pressing = -l->area[m] * opening;
                double normal = opening < 0.0 ? pressing : 0.0;
                to->touching[m] = opening < 0.0;
                to->normal[m] = normal;
                if (fabs(pressing) > pressed) pressed = fabs(pressing);
                if (normal > highest) highest = normal;
                for (int i = 0; i < nn; i++) f[in[i]] += row[i] * normal;
                sum += normal;
            }
            const double *rows = c->slips + g * t * ns;
            for (int i = 0; i < t; i++) {
                e[i] = l->spring[g] * dot(rows + i * ns, slides, ns);
                square += e[i] * e[i];
            }
            double size = t == 1 ? fabs(e[0]) : sqrt(square);
            for (int i = 0; i < t; i++) to->direction[g * t + i] = e[i] /= size > 1e-300 ? size : 1e-300;
            int slack = l->bolted && l->bolted[g] && e[0] > 0.0;
            double strength = (slack ? 0.0 : l->cohesion[g]) + l->friction[g] * sum;
            double allowed = !to->frozen ? reduction * strength : slack ? 0.0 : to->frozen[g];
            double carried = size > allowed ? allowed : size;
            to->strength[g] = strength;
            to->slips[g] = size > allowed;
            to->slip[g] = size / l->spring[g];
            if (size > longest) longest = size;
            for (int i = 0; i < t; i++) {
                double force = to->friction[g * t + i] = -e[i] * carried;
                for (int j = 0; j < ns; j++) f[is[j]] += rows[i * ns + j] * force;
            }
        }
        push(c, k, f, to->unbalanced, u);
    }
    to->highest = highest, to->pressed = pressed, to->longest = longest;
}

/* forces(law, at, reduction, load, frozen or None, normal, friction, strength, touching, slips, direction, slip,
          unbalanced) -> (largest normal force, largest |pressing|, largest elastic shear force) */
static PyObject *forces(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 13)) return NULL;
    const Law *l = PyCapsule_GetPointer(a[0], LAW);
    if (!l) return NULL;
    const Contacts *c = l->of;
    whole size = c->blocks * c->u, m = c->pairs, g = c->groups, t = c->t;
    Kept here = {0}, *kept = &here;
    double reduction = PyFloat_AsDouble(a[2]);
    int failed = PyErr_Occurred() != NULL;
    const double *x = FLOATS(a[1], size), *load = FLOATS(a[3], size);
    Carried to;
    to.frozen = FLOATS(a[4], g);
    to.normal = OUT(a[5], m), to.friction = OUT(a[6], g * t), to.strength = OUT(a[7], g);
    to.touching = OUT_BOOLS(a[8], m), to.slips = OUT_BOOLS(a[9], g);
    to.direction = OUT(a[10], g * t), to.slip = OUT(a[11], g), to.unbalanced = OUT(a[12], size);
    if (!failed) {
        memcpy(to.unbalanced, load, size * sizeof(double));
        if (c->u == 6) forces_in(l, x, reduction, &to, 6, 2);
        else forces_in(l, x, reduction, &to, 3, 1);
    }
    released(kept);
    return failed ? NULL : Py_BuildValue("ddd", to.highest, to.pressed, to.longest);
}

INLINE void viscous_in(const Law *l, const double *x, double factor, double *out, const int u, const int t)
{
    const Contacts *c = l->of;
    const int *in = u == 6 ? NORMAL6 : NORMAL3, *is = u == 6 ? SLIP6 : SLIP3, nn = u == 6 ? 3 : 2, ns = u == 6 ? 3 : 1;
    for (whole k = 0; k < c->contacts; k++) {
        double r[6], opens[3], slides[3], f[6] = {0.0};
        motion_of(c, k, x, r, u);
        for (int i = 0; i < nn; i++) opens[i] = r[in[i]];
        for (int i = 0; i < ns; i++) slides[i] = r[is[i]];
        for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) {
            for (whole m = c->first_pair[g]; m < c->first_pair[g + 1]; m++) {
                const double *row = c->rows + m * nn;
                double force = factor * l->area[m] * dot(row, opens, nn);
                for (int i = 0; i < nn; i++) f[in[i]] += row[i] * force;
            }
            for (int i = 0; i < t; i++) {
                const double *row = c->slips + (g * t + i) * ns;
                double force = factor * l->spring[g] * dot(row, slides, ns);
                for (int j = 0; j < ns; j++) f[is[j]] += row[j] * force;
            }
        }
        push(c, k, f, out, u);
    }
}

/* add_viscous(law, moved, factor, forces): adds factor K_e moved */
static PyObject *add_viscous(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 4)) return NULL;
    const Law *l = PyCapsule_GetPointer(a[0], LAW);
    if (!l) return NULL;
    const Contacts *c = l->of;
    Kept here = {0}, *kept = &here;
    double factor = PyFloat_AsDouble(a[2]);
    int failed = PyErr_Occurred() != NULL;
    const double *x = FLOATS(a[1], c->blocks * c->u);
    double *out = OUT(a[3], c->blocks * c->u);
    if (!failed && c->u == 6) viscous_in(l, x, factor, out, 6, 2);
    else if (!failed) viscous_in(l, x, factor, out, 3, 1);
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- stiffness of contacts (ContactPattern.stiffness, Bed.tangent) -------------------------------------------------- */

INLINE void add_pair(const double *row, double spring, double *s, const int *in, const int nn, const int u)
{
    for (int i = 0; i < nn; i++)
        for (int j = 0; j < nn; j++) s[in[i] * u + in[j]] += spring * row[i] * row[j];
}

/* Adds slips^T T slips. */
INLINE void add_slip(const double *rows, const double *T, double *s, const int *is, const int ns, const int u, const int t)
{
    for (int i = 0; i < t; i++)
        for (int j = 0; j < t; j++) {
            double stiff = i <= j ? T[i * t + j] : T[j * t + i];
            for (int a = 0; a < ns; a++)
                for (int b = 0; b < ns; b++) s[is[a] * u + is[b]] += stiff * rows[i * ns + a] * rows[j * ns + b];
        }
}

INLINE void stiffness_in(const Contacts *c, const double *springs, const double *T, double *out, const int u, const int t)
{
    const int *in = u == 6 ? NORMAL6 : NORMAL3, *is = u == 6 ? SLIP6 : SLIP3, nn = u == 6 ? 3 : 2, ns = u == 6 ? 3 : 1;
    for (whole k = 0; k < c->contacts; k++) {
        double *s = out + k * u * u;
        for (int i = 0; i < u * u; i++) s[i] = 0.0;
        for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) {
            for (whole m = c->first_pair[g]; m < c->first_pair[g + 1]; m++)
                add_pair(c->rows + m * nn, springs[m], s, in, nn, u);
            add_slip(c->slips + g * t * ns, T + g * t * t, s, is, ns, u, t);
        }
    }
}

/* stiffness(contacts, springs, tangent, out) */
static PyObject *stiffness(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 4)) return NULL;
    const Contacts *c = PyCapsule_GetPointer(a[0], CONTACTS);
    if (!c) return NULL;
    Kept here = {0}, *kept = &here;
    int failed = 0;
    const double *springs = FLOATS(a[1], c->pairs), *T = FLOATS(a[2], c->groups * c->t * c->t);
    double *out = OUT(a[3], c->contacts * c->u * c->u);
    if (!failed && c->u == 6) stiffness_in(c, springs, T, out, 6, 2);
    else if (!failed) stiffness_in(c, springs, T, out, 3, 1);
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

INLINE void couple_in(const Contacts *c, const double *springs, const double *tilt, const double *const *weights,
                      double *out, const int u, const int t)
{
    const int *in = u == 6 ? NORMAL6 : NORMAL3, *is = u == 6 ? SLIP6 : SLIP3, nn = u == 6 ? 3 : 2, ns = u == 6 ? 3 : 1;
    for (whole k = 0; k < c->contacts; k++)
        for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) {
            double n[3] = {0.0}, tau[3] = {0.0}, *s = out + k * u * u;
            for (whole m = c->first_pair[g]; m < c->first_pair[g + 1]; m++)
                for (int i = 0; i < nn; i++) n[i] += springs[m] * c->rows[m * nn + i];
            for (int i = 0; i < t; i++)
                for (int a = 0; a < ns; a++) tau[a] += tilt[g * t + i] * c->slips[(g * t + i) * ns + a];
            for (int i = 0; i < nn; i++)
                for (int j = 0; j < nn; j++) s[in[i] * u + in[j]] -= weights[0][g] * n[i] * n[j];
            for (int i = 0; i < nn; i++)
                for (int a = 0; a < ns; a++) {
                    s[in[i] * u + is[a]] -= weights[1][g] * n[i] * tau[a];
                    s[is[a] * u + in[i]] -= weights[2][g] * n[i] * tau[a];
                }
            for (int a = 0; a < ns; a++)
                for (int b = 0; b < ns; b++) s[is[a] * u + is[b]] += weights[3][g] * tau[a] * tau[b];
        }
}

/* couple(contacts, springs, tilt, nn, nt, tn, tt, out): ContactPattern.couple */
static PyObject *couple(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 8)) return NULL;
    const Contacts *c = PyCapsule_GetPointer(a[0], CONTACTS);
    if (!c) return NULL;
    Kept here = {0}, *kept = &here;
    int failed = 0;
    const double *springs = FLOATS(a[1], c->pairs), *tilt = FLOATS(a[2], c->groups * c->t), *weights[4];
    for (int i = 0; i < 4; i++) weights[i] = FLOATS(a[3 + i], c->groups);
    double *out = OUT(a[7], c->contacts * c->u * c->u);
    if (!failed && c->u == 6) couple_in(c, springs, tilt, weights, out, 6, 2);
    else if (!failed) couple_in(c, springs, tilt, weights, out, 3, 1);
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* longest_step(point, step, width) of cones.py */
static PyObject *longest_step(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 3)) return NULL;
    Kept here = {0}, *kept = &here;
    whole width = PyLong_AsLongLong(a[2]);
    int failed = PyErr_Occurred() != NULL || width < 1;
    const double *p = FLOATS(a[0], -1);
    whole rows = failed ? 0 : kept->views[0].len / 8 / width;
    const double *s = FLOATS(a[1], rows * width);
    double most = INFINITY;
    for (whole g = 0; !failed && g < rows; g++, p += width, s += width) {
        double a2 = s[0] * s[0], b = p[0] * s[0], c = p[0] * p[0], side1 = 0.0, side2 = 0.0, side3 = 0.0;
        for (whole i = 1; i < width; i++) side1 += s[i] * s[i], side2 += p[i] * s[i], side3 += p[i] * p[i];
        a2 -= side1, b -= side2, c = c - side3 > 1e-300 ? c - side3 : 1e-300;
        if (b * b >= a2 * c) {
            double root = sqrt(b * b - a2 * c), half = -(b + (b >= 0.0 ? root : -root));
            double ends[2] = {half / a2, c / half};
            for (int i = 0; i < 2; i++)
                if (ends[i] > 0.0 && ends[i] < most) most = ends[i];
        }
        if (s[0] < 0.0 && -p[0] / s[0] < most) most = -p[0] / s[0];
    }
    released(kept);
    return failed ? NULL : PyFloat_FromDouble(most);
}

typedef struct {
    const char *touching, *slips;
    const double *direction, *friction, *slip, *elastic;
    double reduction, viscosity;
    int coupled, turning;
} There;

INLINE void tangent_in(const Law *l, const There *at, double *out, const int u, const int t)
{
    const Contacts *c = l->of;
    const int *in = u == 6 ? NORMAL6 : NORMAL3, *is = u == 6 ? SLIP6 : SLIP3, nn = u == 6 ? 3 : 2, ns = u == 6 ? 3 : 1;
    for (whole k = 0; k < c->contacts; k++) {
        double *s = out + k * u * u;
        for (int i = 0; i < u * u; i++) s[i] = at->elastic ? at->viscosity * at->elastic[k * u * u + i] : 0.0;
        for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) {
            double pressing[3] = {0.0}, T[4], along[3];
            for (whole m = c->first_pair[g]; m < c->first_pair[g + 1]; m++) {
                if (!at->touching[m]) continue;
                const double *row = c->rows + m * nn;
                add_pair(row, l->area[m], s, in, nn, u);
                for (int i = 0; i < nn; i++) pressing[i] += l->area[m] * row[i];
            }
            const double *e = at->direction + g * t, *held = at->friction + g * t, *rows = c->slips + g * t * ns;
            int slips = at->slips[g];
            double sideways = l->spring[g];
            if (slips && !at->turning) sideways = 0.0;
            else if (slips && at->slip[g] > 0.0) sideways = sqrt(dot(held, held, t)) / at->slip[g];
            for (int i = 0; i < t; i++)
                for (int j = 0; j < t; j++)
                    T[i * t + j] = (i == j ? sideways : 0.0) - (slips ? sideways * e[i] * e[j] : 0.0);
            add_slip(rows, T, s, is, ns, u, t);
            if (!slips || !at->coupled) continue;
            double gain = at->reduction * l->friction[g];
            for (int a = 0; a < ns; a++) {
                along[a] = 0.0;
                for (int i = 0; i < t; i++) along[a] += e[i] * rows[i * ns + a];
                for (int b = 0; b < nn; b++) s[is[a] * u + in[b]] -= along[a] * gain * pressing[b];
            }
        }
    }
}

/* tangent(law, reduction, viscosity, coupled, turning, touching, slips, direction, friction, slip, elastic, out) */
static PyObject *tangent(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 12)) return NULL;
    const Law *l = PyCapsule_GetPointer(a[0], LAW);
    if (!l) return NULL;
    const Contacts *c = l->of;
    whole entries = c->contacts * c->u * c->u;
    Kept here = {0}, *kept = &here;
    There at;
    at.reduction = PyFloat_AsDouble(a[1]), at.viscosity = PyFloat_AsDouble(a[2]);
    at.coupled = PyObject_IsTrue(a[3]), at.turning = PyObject_IsTrue(a[4]);
    int failed = PyErr_Occurred() != NULL;
    at.touching = BOOLS(a[5], c->pairs), at.slips = BOOLS(a[6], c->groups);
    at.direction = FLOATS(a[7], c->groups * c->t), at.friction = FLOATS(a[8], c->groups * c->t);
    at.slip = FLOATS(a[9], c->groups), at.elastic = at.viscosity != 0.0 ? FLOATS(a[10], entries) : NULL;
    double *out = OUT(a[11], entries);
    if (!failed && c->u == 6) tangent_in(l, &at, out, 6, 2);
    else if (!failed) tangent_in(l, &at, out, 3, 1);
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- the stiffness of the assembly in the storage of a way (_Plan) --------------------------------------------------- */

typedef struct {
    Kept kept;
    const Contacts *of;
    whole entries, size;
    const whole *index, *at, *diagonal; /* of each entry kept: where it goes, and its place among all (k, 2u, 2u) */
    int symmetric;
} Plan;

/* plan(contacts, symmetric, size, kept, index, diagonal) */
static PyObject *plan(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 6)) return NULL;
    const Contacts *c = PyCapsule_GetPointer(a[0], CONTACTS);
    if (!c) return NULL;
    Plan *p = calloc(1, sizeof *p);
    if (!p) return PyErr_NoMemory();
    Kept *kept = &p->kept;
    p->of = c, kept->other = Py_NewRef(a[0]);
    p->symmetric = PyObject_IsTrue(a[1]), p->size = PyLong_AsLongLong(a[2]);
    int failed = PyErr_Occurred() != NULL;
    p->at = WHOLES(a[3], -1);
    p->entries = failed ? 0 : kept->views[0].len / 8;
    p->index = WHOLES(a[4], p->entries), p->diagonal = WHOLES(a[5], c->blocks * c->u);
    return object_of(p, PLAN, failed);
}

INLINE void assembled_in(const Plan *p, const double *local, double *entries, const int u)
{
    const Contacts *c = p->of;
    whole e = 0;
    for (whole k = 0; k < c->contacts; k++) {
        const double *s = local + k * u * u, *side[2] = {c->plus_motion + k * u * u, c->minus_motion + k * u * u};
        const int sides = c->minus[k] < 0 ? 1 : 2;
        double half[2][36], v[144];
        for (int q = 0; q < sides; q++)
            for (int i = 0; i < u; i++) {
                double row[6] = {0.0};
                for (int j = 0; j < u; j++)
                    for (int b = 0; b < u; b++) row[b] += s[i * u + j] * side[q][j * u + b];
                for (int b = 0; b < u; b++) half[q][i * u + b] = row[b];
            }
        for (int p1 = 0; p1 < sides; p1++)
            for (int q = 0; q < sides; q++)
                for (int i = 0; i < u; i++) {
                    double row[6] = {0.0};
                    for (int j = 0; j < u; j++)
                        for (int b = 0; b < u; b++) row[b] += side[p1][j * u + i] * half[q][j * u + b];
                    for (int b = 0; b < u; b++) v[(p1 * u + i) * 2 * u + q * u + b] = row[b];
                }
        const whole base = k * 4 * u * u, end = base + 4 * u * u;
        for (; e < p->entries && p->at[e] < end; e++) entries[p->index[e]] += v[p->at[e] - base];
    }
}

/* assembled(plan, local, shift, inertia or None, entries), entries all zero before */
static PyObject *assembled(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 5)) return NULL;
    const Plan *p = PyCapsule_GetPointer(a[0], PLAN);
    if (!p) return NULL;
    const Contacts *c = p->of;
    whole size = c->blocks * c->u;
    Kept here = {0}, *kept = &here;
    double shift = PyFloat_AsDouble(a[2]), sum = 0.0;
    int failed = PyErr_Occurred() != NULL;
    const double *local = FLOATS(a[1], c->contacts * c->u * c->u), *inertia = FLOATS(a[3], size);
    double *entries = OUT(a[4], p->size);
    if (!failed) {
        if (c->u == 6) assembled_in(p, local, entries, 6);
        else assembled_in(p, local, entries, 3);
        for (whole i = 0; i < size; i++) {
            if (inertia) entries[p->diagonal[i]] += inertia[i];
            sum += fabs(entries[p->diagonal[i]]);
        }
        for (whole i = 0; i < size; i++) {
            double *d = entries + p->diagonal[i];
            *d += shift * ((p->symmetric ? *d : fabs(*d)) + sum / size);
        }
    }
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- fronts (Fronts.factored) ---------------------------------------------------------------------------------------- */

typedef double D;
static void (*dgetrf)(int *, int *, D *, int *, int *, int *);
static void (*dpotrf)(char *, int *, D *, int *, int *);
static void (*dtrsm)(char *, char *, char *, char *, int *, int *, D *, D *, int *, D *, int *);
static void (*dgemm)(char *, char *, int *, int *, int *, D *, D *, int *, D *, int *, D *, D *, int *);
static void (*dsyrk)(char *, char *, int *, int *, D *, D *, int *, D *, D *, int *);
static void (*dtrsv)(char *, char *, char *, int *, D *, int *, D *, int *);
static void (*dgemv)(char *, int *, int *, D *, D *, int *, D *, int *, D *, D *, int *);
static struct { const char *name; void *to; } ROUTINES[] = {
    {"dgetrf", &dgetrf}, {"dpotrf", &dpotrf}, {"dtrsm", &dtrsm}, {"dgemm", &dgemm}, {"dsyrk", &dsyrk},
    {"dtrsv", &dtrsv}, {"dgemv", &dgemv},
};

/* bind(routines): SciPy's, {name: capsule} */
static PyObject *bind(PyObject *self, PyObject *routines)
{
    for (size_t i = 0; i < sizeof ROUTINES / sizeof *ROUTINES; i++) {
        PyObject *capsule = PyMapping_GetItemString(routines, ROUTINES[i].name);
        if (!capsule) return NULL;
        const char *types = PyCapsule_GetName(capsule); /* of the arguments: integers of 32 bits are what we pass */
        void *pointer = PyCapsule_GetPointer(capsule, types);
        int fits = pointer && (strstr(types, "(int *") || strstr(types, ", int *"));
        if (pointer && !fits) PyErr_Format(PyExc_ValueError, "SciPy's %s takes other integers", ROUTINES[i].name);
        Py_DECREF(capsule);
        if (!fits) return NULL;
        memcpy(ROUTINES[i].to, &pointer, sizeof pointer);
    }
    return Py_NewRef(Py_None);
}

typedef struct {
    Kept kept;
    whole count, u, size, unknowns, storage, widest;
    /* of each front: first unknown, unknowns, later ones, its entries, its update in the workspace, its later blocks in
       `later`; its children in `child`, (count + 1); of each block of `place`: where it is in the parent's front */
    const whole *start, *own, *others, *offset, *update, *first_later, *first_child, *child, *later, *place;
    int symmetric;
    double *work;
} Fronts;

/* fronts(u, symmetric, unknowns, storage, workspace, start, own, others, offset, update, first_later, first_child,
          child, later, place) */
static PyObject *fronts(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 15)) return NULL;
    Fronts *f = calloc(1, sizeof *f);
    if (!f) return PyErr_NoMemory();
    Kept *kept = &f->kept;
    f->u = PyLong_AsLongLong(a[0]), f->symmetric = PyObject_IsTrue(a[1]), f->unknowns = PyLong_AsLongLong(a[2]);
    f->storage = PyLong_AsLongLong(a[3]);
    whole work = PyLong_AsLongLong(a[4]);
    int failed = PyErr_Occurred() != NULL;
    f->start = WHOLES(a[5], -1);
    whole k = f->count = failed ? 0 : kept->views[0].len / 8;
    f->own = WHOLES(a[6], k), f->others = WHOLES(a[7], k), f->offset = WHOLES(a[8], k), f->update = WHOLES(a[9], k);
    f->first_later = WHOLES(a[10], k + 1), f->first_child = WHOLES(a[11], k + 1), f->child = WHOLES(a[12], -1);
    whole later = failed ? 0 : f->first_later[k];
    f->later = WHOLES(a[13], later), f->place = WHOLES(a[14], later);
    for (whole i = 0; i < f->count; i++)
        if (f->others[i] > f->widest) f->widest = f->others[i];
    if (!failed && !(f->work = malloc((work + f->widest + 1) * sizeof(double)))) {
        PyErr_NoMemory();
        failed = 1;
    }
    PyObject *capsule = object_of(f, FRONTS, failed);
    if (capsule) PyCapsule_SetContext(capsule, f->work);
    return capsule;
}

/* Adds the update (q, q) of a child to a front: `place` of its blocks, first those of the front's own. */
static void extend(const Fronts *f, whole child, D *own, D *below, D *beside, D *rest, whole p, whole q)
{
    const whole u = f->u, wide = f->others[child], blocks = wide / u, *place = f->place + f->first_later[child];
    const D *more = f->work + f->update[child];
    for (whole b = 0; b < blocks; b++)
        for (whole column = 0; column < u; column++) {
            const whole at = place[b] * u + column;
            const D *from = more + (b * u + column) * wide;
            for (whole a = f->symmetric ? b : 0; a < blocks; a++) {
                const whole row = place[a] * u;
                D *to;
                if (at < p) to = row < p ? own + at * p + row : below + at * q + row - p;
                else if (row >= p) to = rest + (at - p) * q + row - p;
                else { /* stored transposed */
                    for (whole i = 0; i < u; i++) beside[(row + i) * q + at - p] += from[a * u + i];
                    continue;
                }
                for (whole i = 0; i < u; i++) to[i] += from[a * u + i];
            }
        }
}

/* factored(fronts, growth, entries, pivots) -> whether it went */
static PyObject *factored(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 4)) return NULL;
    const Fronts *f = PyCapsule_GetPointer(a[0], FRONTS);
    if (!f) return NULL;
    Kept here = {0}, *kept = &here;
    double growth = PyFloat_AsDouble(a[1]), one = 1.0, less = -1.0;
    int failed = PyErr_Occurred() != NULL, good = 1;
    double *entries = OUT(a[2], f->storage);
    int *pivots = (int *)taken(kept, a[3], f->unknowns, sizeof(int), 1, &failed);
    for (whole k = 0; !failed && good && k < f->count; k++) {
        int p = (int)f->own[k], q = (int)f->others[k], info = 0;
        D *own = entries + f->offset[k], *below = own + f->own[k] * p, *beside = below + f->own[k] * q;
        D *rest = f->work + f->update[k];
        memset(rest, 0, f->others[k] * q * sizeof(D));
        for (whole i = f->first_child[k]; i < f->first_child[k + 1]; i++)
            extend(f, f->child[i], own, below, beside, rest, p, q);
        if (f->symmetric) {
            dpotrf("L", &p, own, &p, &info);
            good = info == 0;
            if (!good || !q) continue;
            dtrsm("R", "L", "T", "N", &q, &p, &one, own, &p, below, &q);
            dsyrk("L", "N", &q, &p, &less, below, &q, &one, rest, &q);
            continue;
        }
        int *swap = pivots + f->start[k];
        dgetrf(&p, &p, own, &p, swap, &info);
        good = info == 0;
        if (!good || !q) continue;
        dtrsm("R", "U", "N", "N", &q, &p, &one, own, &p, below, &q);
        for (whole i = 0; i < f->own[k] * q; i++) good &= fabs(below[i]) < growth;
        for (int i = 0; i < p; i++) {
            D *x = beside + (whole)i * q, *y = beside + (whole)(swap[i] - 1) * q;
            for (int j = 0; x != y && j < q; j++) {
                D kept_one = x[j];
                x[j] = y[j], y[j] = kept_one;
            }
        }
        dtrsm("R", "L", "T", "U", &q, &p, &one, own, &p, beside, &q);
        dgemm("N", "T", &q, &q, &p, &less, below, &q, beside, &q, &one, rest, &q);
    }
    released(kept);
    return failed ? NULL : PyBool_FromLong(good);
}

/* solved(fronts, entries, pivots, found): in place */
static PyObject *solved(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 4)) return NULL;
    const Fronts *f = PyCapsule_GetPointer(a[0], FRONTS);
    if (!f) return NULL;
    Kept here = {0}, *kept = &here;
    int failed = 0, step = 1;
    double one = 1.0, less = -1.0, none = 0.0, *gathered = f->work;
    D *entries = (D *)FLOATS(a[1], f->storage);
    const int *pivots = (int *)taken(kept, a[2], f->unknowns, sizeof(int), 0, &failed);
    double *x = OUT(a[3], f->unknowns);
    char *unit = f->symmetric ? "N" : "U";
    for (whole k = 0; !failed && k < f->count; k++) {
        int p = (int)f->own[k], q = (int)f->others[k];
        D *own = entries + f->offset[k], *below = own + f->own[k] * p, *here_x = x + f->start[k];
        const whole *later = f->later + f->first_later[k];
        for (int i = 0; !f->symmetric && i < p; i++) {
            int j = pivots[f->start[k] + i] - 1;
            D other = here_x[j];
            here_x[j] = here_x[i], here_x[i] = other;
        }
        dtrsv("L", "N", unit, &p, own, &p, here_x, &step);
        if (!q) continue;
        dgemv("N", &q, &p, &one, below, &q, here_x, &step, &none, gathered, &step);
        for (whole b = 0; b < q / f->u; b++)
            for (whole i = 0; i < f->u; i++) x[later[b] * f->u + i] -= gathered[b * f->u + i];
    }
    for (whole k = f->count - 1; !failed && k >= 0; k--) {
        int p = (int)f->own[k], q = (int)f->others[k];
        D *own = entries + f->offset[k], *below = own + f->own[k] * p, *here_x = x + f->start[k];
        const whole *later = f->later + f->first_later[k];
        if (q) {
            for (whole b = 0; b < q / f->u; b++)
                for (whole i = 0; i < f->u; i++) gathered[b * f->u + i] = x[later[b] * f->u + i];
            D *beside = f->symmetric ? below : below + f->own[k] * q;
            dgemv("T", &q, &p, &less, beside, &q, gathered, &step, &one, here_x, &step);
        }
        if (f->symmetric) dtrsv("L", "T", "N", &p, own, &p, here_x, &step);
        else dtrsv("U", "N", "N", &p, own, &p, here_x, &step);
    }
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- the module ------------------------------------------------------------------------------------------------------ */

#define FAST(name) {#name, (PyCFunction)(void (*)(void))name, METH_FASTCALL, NULL}
static PyMethodDef METHODS[] = {
    FAST(contacts), FAST(law), FAST(forces), FAST(add_viscous), FAST(stiffness), FAST(couple), FAST(tangent), FAST(plan),
    FAST(longest_step), FAST(assembled), FAST(fronts), FAST(factored), FAST(solved), {"bind", bind, METH_O, NULL}, {NULL},
};

static struct PyModuleDef MODULE = {PyModuleDef_HEAD_INIT, .m_name = "_kernels", .m_size = -1, .m_methods = METHODS};

PyMODINIT_FUNC PyInit__kernels(void)
{
    PyObject *module = PyModule_Create(&MODULE);
    if (module && PyModule_AddIntConstant(module, "SOURCE", (long)SOURCE) < 0) Py_CLEAR(module);
    return module;
}
