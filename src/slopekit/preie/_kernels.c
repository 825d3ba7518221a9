/* The loops that take the time of many blocks, and of one on its cracked base, compiled: what bed.py, patterns.py,
   stiffness.py and polygon_bed.py do with NumPy.

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
    const double *direction, *friction, *slip, *elastic, *share_slopes, *cohesion;
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
            if (!slips) continue;
            for (int a = 0; a < ns; a++) {
                along[a] = 0.0;
                for (int i = 0; i < t; i++) along[a] += e[i] * rows[i * ns + a];
            }
            const double gain = at->coupled ? at->reduction * l->friction[g] : 0.0;
            for (int a = 0; gain != 0.0 && a < ns; a++)
                for (int b = 0; b < nn; b++) s[is[a] * u + in[b]] -= along[a] * gain * pressing[b];
            const double bond = at->share_slopes ? at->reduction * at->cohesion[g] : 0.0;
            for (int a = 0; bond != 0.0 && a < ns; a++)
                for (int b = 0; b < u; b++) s[is[a] * u + b] += along[a] * bond * at->share_slopes[g * u + b];
        }
    }
}

/* -- the pressed share of contacts (ContactCells.pressed_share) -------------------------------------------------------- */

/* The part of a cell whose gap, linear between its corners, is negative, and its slopes by the gaps. */
INLINE double pressed_fraction(const double *gap, double *slope, const int corners)
{
    int count = 0;
    for (int v = 0; v < corners; v++) count += gap[v] < 0.0, slope[v] = 0.0;
    if (count == 0 || count == corners) return count ? 1.0 : 0.0;
    int lone = 0, alone = count == 1;
    while ((gap[lone] < 0.0) != alone) lone++;
    double a = gap[lone], side = 1.0, sum = 0.0, sign = alone ? 1.0 : -1.0;
    for (int v = 0; v < corners; v++)
        if (v != lone) side *= a / (a - gap[v]);
    for (int v = 0; v < corners; v++)
        if (v != lone) slope[v] = sign * side / (a - gap[v]), sum += slope[v];
    slope[lone] = a != 0.0 ? sign * side * (corners - 1) / a - sum : 0.0;
    return alone ? side : 1.0 - side;
}

/* pressed_share(law, cells, corners, groups, contact, corner, group, part, touches, displacement, share, slopes) */
static PyObject *pressed_share(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 12)) return NULL;
    const Law *l = PyCapsule_GetPointer(a[0], LAW);
    if (!l) return NULL;
    const Contacts *c = l->of;
    const int u = c->u, *in = u == 6 ? NORMAL6 : NORMAL3, nn = u == 6 ? 3 : 2;
    const whole cells = PyLong_AsLongLong(a[1]);
    const int corners = (int)PyLong_AsLong(a[2]), groups = (int)PyLong_AsLong(a[3]);
    const double touches = PyFloat_AsDouble(a[8]);
    Kept here = {0}, *kept = &here;
    int failed = PyErr_Occurred() != NULL || corners > 3;
    const whole *contact = WHOLES(a[4], cells), *corner = WHOLES(a[5], cells * corners);
    const whole *group = WHOLES(a[6], cells * groups);
    const double *part = FLOATS(a[7], cells * groups), *x = FLOATS(a[9], c->blocks * u);
    double *share = OUT(a[10], c->groups), *slopes = OUT(a[11], c->groups * u), r[6];
    for (whole i = 0; !failed && i < cells; i++) {
        const whole k = contact[i];
        if (i == 0 || contact[i - 1] != k) {
            motion_of(c, k, x, r, u);
            if (l->held)
                for (int j = 0; j < u; j++) r[j] += l->held[k * u + j];
            for (whole g = c->first_group[k]; g < c->first_group[k + 1]; g++) share[g] = 0.0;
        }
        double gap[3], slope[3], by[3] = {0.0}, opens[3];
        for (int j = 0; j < nn; j++) opens[j] = r[in[j]];
        for (int v = 0; v < corners; v++) gap[v] = dot(c->rows + corner[i * corners + v] * nn, opens, nn) - touches;
        const double fraction = pressed_fraction(gap, slope, corners);
        for (int v = 0; v < corners; v++)
            for (int j = 0; j < nn; j++) by[j] += slope[v] * c->rows[corner[i * corners + v] * nn + j];
        for (int e = 0; e < groups; e++) {
            const whole g = group[i * groups + e];
            share[g] += part[i * groups + e] * fraction;
            for (int j = 0; j < nn; j++) slopes[g * u + in[j]] += part[i * groups + e] * by[j];
        }
    }
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* tangent(law, reduction, viscosity, coupled, turning, touching, slips, direction, friction, slip, elastic,
   slopes of the pressed share or None, cohesion, out) */
static PyObject *tangent(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 14)) return NULL;
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
    at.share_slopes = FLOATS(a[11], c->groups * c->u), at.cohesion = FLOATS(a[12], c->groups);
    double *out = OUT(a[13], entries);
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

/* Adds the update (q, q) of a child to a front: `place` of its blocks, first those of the front's own. By tiles of two
   blocks, whose u columns lie in the cache; what goes to `beside` is turned, so that it is written in order. */
INLINE void extend(const Fronts *f, whole child, D *own, D *below, D *beside, D *rest, whole p, whole q, const int u)
{
    const whole wide = f->others[child], blocks = wide / u, *place = f->place + f->first_later[child];
    const D *more = f->work + f->update[child];
    for (whole b = 0; b < blocks; b++) {
        const whole at = place[b] * u;
        for (whole a = f->symmetric ? b : 0; a < blocks; a++) {
            const whole row = place[a] * u;
            const D *restrict from = more + b * u * wide + a * u;
            if (at >= p && row < p) { /* stored transposed */
                D *restrict to = beside + row * q + at - p;
                for (int i = 0; i < u; i++)
                    for (int column = 0; column < u; column++) to[i * q + column] += from[column * wide + i];
                continue;
            }
            D *restrict to = at >= p   ? rest + (at - p) * q + row - p
                             : row < p ? own + at * p + row
                                       : below + at * q + row - p;
            const whole step = at < p && row < p ? p : q;
            for (int column = 0; column < u; column++)
                for (int i = 0; i < u; i++) to[column * step + i] += from[column * wide + i];
        }
    }
}

/* Whether all of some entries are smaller than a positive number, none of them NaN. As integers doubles without their
   sign are in the same order, NaN last. */
static int all_smaller(const D *entries, whole count, double than)
{
    const uint64_t size = ~(uint64_t)0 >> 1;
    uint64_t below = ~(uint64_t)0, limit;
    memcpy(&limit, &than, sizeof limit);
    for (whole i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, entries + i, sizeof bits);
        below &= (bits & size) - limit;
    }
    return below >> 63;
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
            if (f->u == 6) extend(f, f->child[i], own, below, beside, rest, p, q, 6);
            else extend(f, f->child[i], own, below, beside, rest, p, q, (int)f->u);
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
        good = all_smaller(below, f->own[k] * q, growth);
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

/* -- one block on an elastic bed (BedSprings.unbalanced) -------------------------------------------------------------- */

/* An end of the new edge of a contact that is cut: which corner of the part it is, the way it can go, how far it goes
   with the gap by 1, ξ and η; what it moves of a triangle and of points, and the sums of the shear that it brings. */
#define POINTS 64 /* of a contact at a time */
typedef struct {
    whole corner;
    double way[2], by_gap[3], middle[2], growth, point[2][POINTS], area[POINTS], by[2][3];
} End;

typedef struct {
    Kept kept;
    whole u, blocks, contacts, points[2]; /* points of a line and of a triangle */
    const double *at[2], *shares[2];  /* their barycentric coordinates (2, q) and (3, q), and their shares (q) */
    const whole *contact;             /* first contact of each block, (blocks + 1) */
    const whole *first;               /* first corner of each contact, (k + 1) */
    const double *rows, *plane, *law; /* (k, 9, u) by 1, ξ and η; corners (2); area per area, cohesion, tan φ (k, 3) */
    double spring, least;             /* k_t / k_n; slips of this size and below have no direction */
    PyObject *strengths;              /* of curved laws: called with a contact and how many points it has; or NULL */
    const char *curved;               /* which contacts have one */
    double *curve;                    /* (3, room): their normal tractions, strengths and slopes */
    whole room, next;                 /* the next point of them; -1 on a line */
    int asks, broken;                 /* whether the tractions are collected; whether the law raised an error */
    whole bolts;                      /* passive ones of each block */
    const double *bolt_rows, *capacity, *stiff; /* (blocks, bolts, u), and (blocks, bolts) */
    double moves;                     /* bolts drawn out by more than this pull fully where a block runs */
    double *gaps, *corners, *moves_by; /* of one contact: room for all of it, for its part, and for its ends */
    whole count;                      /* of points that were not summed yet, and where they are */
    double x[POINTS], y[POINTS], area[POINTS];
    End *ends;
} Polygons;

/* Sums over the points of one contact: of the slopes by products of 1, ξ and η, of the forces by 1, ξ and η. */
typedef struct {
    double second[6][6], first[4][3];
} Sums;

static const char POLYGONS[] = "slopekit.polygons";

/* polygons(u, spring, least, contact, first, rows, plane, law, points of a line, shares, points of a triangle, shares,
            strengths or None, curved, curve (3, room), bolts, their capacities, springs, motion that is none) */
static PyObject *polygons(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 19)) return NULL;
    Polygons *p = calloc(1, sizeof *p);
    if (!p) return PyErr_NoMemory();
    Kept *kept = &p->kept;
    p->u = PyLong_AsLongLong(a[0]), p->spring = PyFloat_AsDouble(a[1]), p->least = PyFloat_AsDouble(a[2]);
    int failed = PyErr_Occurred() != NULL;
    if (!failed && !(p->u > 0 && p->u <= 6)) {
        PyErr_SetString(PyExc_ValueError, "a block has up to six unknowns");
        failed = 1;
    }
    p->contact = WHOLES(a[3], -1);
    p->blocks = failed ? 0 : kept->views[0].len / 8 - 1;
    whole k = p->contacts = failed ? 0 : p->contact[p->blocks], most = 0;
    p->first = WHOLES(a[4], k + 1), p->rows = FLOATS(a[5], k * 9 * p->u);
    p->plane = FLOATS(a[6], failed ? 0 : p->first[k] * 2), p->law = FLOATS(a[7], k * 3);
    for (int i = 0; i < 2; i++) {
        p->shares[i] = FLOATS(a[9 + 2 * i], -1);
        p->points[i] = failed ? 0 : kept->views[kept->arrays - 1].len / 8;
        p->at[i] = FLOATS(a[8 + 2 * i], p->points[i] * (2 + i));
    }
    for (whole i = 0; !failed && i < k; i++)
        if (p->first[i + 1] - p->first[i] > most) most = p->first[i + 1] - p->first[i];
    p->capacity = FLOATS(a[16], -1);
    p->bolts = failed || !p->blocks ? 0 : kept->views[kept->arrays - 1].len / 8 / p->blocks;
    p->bolt_rows = FLOATS(a[15], p->blocks * p->bolts * p->u), p->stiff = FLOATS(a[17], p->blocks * p->bolts);
    p->moves = PyFloat_AsDouble(a[18]);
    if (a[12] != Py_None) {
        p->strengths = kept->other = Py_NewRef(a[12]);
        p->curved = BOOLS(a[13], k), p->curve = OUT(a[14], -1);
        p->room = failed ? 0 : kept->views[kept->arrays - 1].len / 24;
        if (!failed && p->room < (most + 2) * (p->points[1] > p->points[0] ? p->points[1] : p->points[0])) {
            PyErr_SetString(PyExc_ValueError, "too little room for the points of a contact");
            failed = 1;
        }
    }
    char *room = failed ? NULL : malloc((size_t)(most + 1) * (sizeof(End) + 11 * sizeof(double)));
    if (!failed && !room) {
        PyErr_NoMemory();
        failed = 1;
    }
    p->ends = (End *)room, p->gaps = (double *)(p->ends + most + 1), p->corners = p->gaps + most + 1;
    p->moves_by = p->corners + 4 * (most + 1);
    PyObject *capsule = object_of(p, POLYGONS, failed);
    if (capsule) PyCapsule_SetContext(capsule, room);
    return capsule;
}

/* Clips what is pressed (gap < 0) out of a contact of `count` corners: `_pressed` of polygon_bed.py. */
static const double *pressed_part(Polygons *p, const double *plane, whole count, whole *left, whole *ends)
{
    double least = p->gaps[0], most = p->gaps[0];
    for (whole k = 1; k < count; k++) {
        if (p->gaps[k] < least) least = p->gaps[k];
        if (p->gaps[k] > most) most = p->gaps[k];
    }
    *ends = 0, *left = most <= 0.0 ? count : 0;
    if (most <= 0.0 || least >= 0.0) return plane;
    for (whole k = 0; k < count; k++) {
        whole after = k + 1 < count ? k + 1 : 0;
        double here = p->gaps[k], there = p->gaps[after], *corner = p->corners + 2 * *left;
        if (here < 0.0) {
            corner[0] = plane[2 * k], corner[1] = plane[2 * k + 1];
            *left += 1, corner += 2;
        }
        if ((here < 0.0) == (there < 0.0) || (count == 2 && k)) continue;
        End *end = p->ends + *ends;
        double part = here / (here - there), square = (here - there) * (here - there);
        end->corner = *left, *left += 1, *ends += 1;
        end->by_gap[0] = (here - there) / square;
        for (int i = 0; i < 2; i++) {
            double from = plane[2 * k + i], to = plane[2 * after + i];
            corner[i] = (1.0 - part) * from + part * to;
            end->way[i] = to - from;
            end->by_gap[1 + i] = (here * to - there * from) / square;
        }
    }
    return p->corners;
}

/* What a contact is asked for: its line, its motion by 1, ξ and η, λ, and whether it runs or sticks. */
typedef struct {
    const double *law;
    double field[3][3], reduction;
    int running, sticks;
} Asked;

typedef double Lanes __attribute__((vector_size(32), aligned(8)));

/* Adds the products of numbers at points with others at the same points, in four lanes each. */
INLINE void add_products(const double *one, const double (*others)[POINTS], const int many, whole count, double *to)
{
    Lanes sums[6] = {{0.0}};
    for (whole q = 0; q < count; q += 4)
        for (int j = 0; j < many; j++) sums[j] += *(const Lanes *)(one + q) * *(const Lanes *)(others[j] + q);
    for (int j = 0; j < many; j++) to[j] += (sums[j][0] + sums[j][1]) + (sums[j][2] + sums[j][3]);
}

/* Adds the points that wait, with their areas, to the sums, and to those of the ends, which move them. */
INLINE void sum_points(Polygons *p, const Asked *s, whole ends, Sums *to)
{
    const double (*f)[3] = s->field, *law = s->law, none = s->running ? 0.0 : p->spring;
    const double allows = s->sticks ? INFINITY : s->running ? -INFINITY : 0.0;
    double powers[6][POINTS], normal[POINTS], strength[POINTS], steep[POINTS], way[2][POINTS], shears[POINTS];
    double turnings[POINTS], slipping[POINTS], dragging[POINTS], slopes[6][POINTS], forces[4][POINTS];
    whole count = p->count, full = (count + 3) / 4 * 4;
    p->count = 0;
    for (whole q = count; q < full; q++) { /* points of no area fill the lanes */
        p->x[q] = p->x[count - 1], p->y[q] = p->y[count - 1], p->area[q] = 0.0;
        for (End *end = p->ends; end < p->ends + ends; end++)
            end->point[0][q] = end->point[1][q] = end->area[q] = 0.0;
    }
    for (whole q = 0; q < full; q++) {
        normal[q] = f[0][0] + f[0][1] * p->x[q] + f[0][2] * p->y[q];
        strength[q] = law[1] + law[2] * normal[q], steep[q] = law[2];
    }
    if (p->next >= 0) {
        double *at = p->curve + p->next;
        p->next += count;
        for (whole q = 0; q < count; q++) {
            if (p->asks) at[q] = normal[q];
            else strength[q] = at[q + p->room], steep[q] = at[q + 2 * p->room];
        }
        if (p->asks) return;
    }
    for (whole q = 0; q < full; q++) {
        double x = p->x[q], y = p->y[q], area = p->area[q];
        double first = f[1][0] + f[1][1] * x + f[1][2] * y, second = f[2][0] + f[2][1] * x + f[2][2] * y;
        double size = sqrt(first * first + second * second), elastic = p->spring * size;
        double allowed = s->reduction * strength[q];
        size = size > p->least ? size : p->least;
        first /= size, second /= size;
        int slides = elastic > allowed + allows;
        double shear = slides ? allowed : elastic, sliding = slides ? area : 0.0, stiff = shear / size;
        double turning = area * (elastic == 0.0 ? none : stiff), slips = slides ? turning : 0.0;
        double drags = sliding * (s->reduction * steep[q]), turned = slips * first, carried = area * shear;
        double lost = sliding * strength[q];
        powers[0][q] = 1.0, powers[1][q] = x, powers[2][q] = y;
        powers[3][q] = x * x, powers[4][q] = x * y, powers[5][q] = y * y;
        slopes[0][q] = -area, slopes[1][q] = drags * first, slopes[2][q] = drags * second;
        slopes[3][q] = turning - turned * first, slopes[4][q] = -turned * second;
        slopes[5][q] = turning - slips * second * second;
        forces[0][q] = carried * first, forces[1][q] = carried * second;
        forces[2][q] = lost * first, forces[3][q] = lost * second;
        way[0][q] = first, way[1][q] = second, shears[q] = shear;
        turnings[q] = turning, slipping[q] = slips, dragging[q] = drags;
    }
    for (int i = 0; i < 6; i++) add_products(slopes[i], powers, 6, full, to->second[i]);
    for (int i = 0; i < 4; i++) add_products(forces[i], powers, 3, full, to->first[i]);
    for (End *end = p->ends; end < p->ends + ends; end++) {
        double gained[2][POINTS];
        for (whole q = 0; q < full; q++) {
            double x = end->point[0][q], y = end->point[1][q], first = way[0][q], second = way[1][q];
            double pressed = f[0][1] * x + f[0][2] * y;
            double slipped[2] = {f[1][1] * x + f[1][2] * y, f[2][1] * x + f[2][2] * y};
            double more = end->area[q] * shears[q] - (slipped[0] * first + slipped[1] * second) * slipping[q] +
                          dragging[q] * pressed;
            gained[0][q] = more * first + turnings[q] * slipped[0];
            gained[1][q] = more * second + turnings[q] * slipped[1];
        }
        for (int i = 0; i < 2; i++) {
            add_products(gained[i], powers, 3, full, end->by[i]);
            add_products(forces[i], end->point, 2, full, end->by[i] + 1);
        }
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void wide_points(Polygons *p, const Asked *s, whole ends, Sums *to)
{
    sum_points(p, s, ends, to);
}
#endif

static void add_points(Polygons *p, const Asked *s, whole ends, Sums *to)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) {
        wide_points(p, s, ends, to);
        return;
    }
#endif
    sum_points(p, s, ends, to);
}

/* Puts some points of a triangle, or of a line, to those that wait: at weights of its corners (2) each. */
INLINE whole put_points(Polygons *p, const int corners, const double (*c)[2], const double *ends_by, whole q,
                        double size, whole ends)
{
    whole is = corners - 2, all = p->points[is], room = POINTS - p->count, count = all - q < room ? all - q : room;
    const double *at = p->at[is] + q, *shares = p->shares[is] + q;
    double *x = p->x + p->count, *y = p->y + p->count, *area = p->area + p->count;
    for (whole i = 0; i < count; i++) {
        x[i] = at[i] * c[0][0] + at[i + all] * c[1][0], y[i] = at[i] * c[0][1] + at[i + all] * c[1][1];
        if (corners == 3) x[i] += at[i + 2 * all] * c[2][0], y[i] += at[i + 2 * all] * c[2][1];
        area[i] = size * shares[i];
    }
    for (whole m = 0; m < ends; m++, ends_by += 2 * corners) {
        End *end = p->ends + m;
        double *moved = end->area + p->count, *to[2] = {end->point[0] + p->count, end->point[1] + p->count};
        for (int j = 0; j < 2; j++)
            for (whole i = 0; i < count; i++) {
                to[j][i] = at[i] * ends_by[j] + at[i + all] * ends_by[2 + j];
                if (corners == 3) to[j][i] += at[i + 2 * all] * ends_by[4 + j];
            }
        for (whole i = 0; i < count; i++) moved[i] = end->growth * shares[i];
    }
    p->count += count;
    return count;
}

/* The part of a line between two corners. */
static void add_line(Polygons *p, const double *c, const Asked *s, whole ends, Sums *to)
{
    double way[2] = {c[2] - c[0], c[3] - c[1]}, length = hypot(way[0], way[1]), by[4] = {0.0};
    const double corners[2][2] = {{c[0], c[1]}, {c[2], c[3]}};
    End *end = p->ends;
    if (ends) {
        end->growth = (way[0] * end->way[0] + way[1] * end->way[1]) / length * (end->corner ? 1.0 : -1.0) * s->law[0];
        memcpy(by + 2 * end->corner, end->way, sizeof end->way);
    }
    for (whole q = 0; q < p->points[0]; add_points(p, s, ends, to))
        q += put_points(p, 2, corners, by, q, length * s->law[0], ends);
}

/* Twice the area of the triangle of a point and two arms. */
INLINE double turn(const double *one, const double *other)
{
    return one[0] * other[1] - one[1] * other[0];
}

/* The triangles of a part about its centroid: `_fan` of polygon_bed.py. `by` (ends, 3, 2) has room. */
static void add_fan(Polygons *p, const double *c, whole count, const Asked *s, whole ends, double *by, Sums *to)
{
    double middle[2] = {0.0, 0.0}, moment[2] = {0.0, 0.0}, all = 0.0;
    for (whole k = 0; k < count; k++)
        for (int i = 0; i < 2; i++) middle[i] += c[2 * k + i] / count;
    for (int round = 0; round < 2; round++) { /* then about the centroid itself */
        all = 0.0;
        for (whole k = 0; k < count; k++) {
            const double *here = c + 2 * k, *after = c + 2 * (k + 1 < count ? k + 1 : 0);
            double one[2] = {here[0] - middle[0], here[1] - middle[1]};
            double other[2] = {after[0] - middle[0], after[1] - middle[1]}, twice = turn(one, other);
            all += twice;
            for (int i = 0; i < 2 && !round; i++) moment[i] += twice * (one[i] + other[i]);
        }
        for (int i = 0; i < 2 && !round && all != 0.0; i++) middle[i] += moment[i] / (3.0 * all);
    }
    for (whole m = 0; m < ends; m++) { /* the part gains a sliver along the new edge, closed at its other end */
        End *end = p->ends + m;
        const double *corner = c + 2 * end->corner, *far = c + 2 * p->ends[ends - 1 - m].corner;
        const double *before = c + 2 * (end->corner ? end->corner - 1 : count - 1);
        const double *after = c + 2 * (end->corner + 1 < count ? end->corner + 1 : 0);
        double across[2] = {after[0] - before[0], after[1] - before[1]}, gain = turn(end->way, across) / all;
        for (int i = 0; i < 2; i++) end->middle[i] = gain * ((2.0 * corner[i] + far[i]) / 3.0 - middle[i]);
    }
    for (whole k = 0; k < count; k++) {
        whole next = k + 1 < count ? k + 1 : 0;
        const double *here = c + 2 * k, *after = c + 2 * next;
        double one[2] = {here[0] - middle[0], here[1] - middle[1]};
        double other[2] = {after[0] - middle[0], after[1] - middle[1]}, size = 0.5 * fabs(turn(one, other));
        for (End *end = p->ends; end < p->ends + ends; end++) {
            double a[2] = {-end->middle[0], -end->middle[1]}, b[2] = {a[0], a[1]};
            for (int i = 0; i < 2 && end->corner == k; i++) a[i] += end->way[i];
            for (int i = 0; i < 2 && end->corner == next; i++) b[i] += end->way[i];
            end->growth = copysign(0.5, all) * (turn(a, other) + turn(one, b)) * s->law[0];
            double *moves = by + 6 * (end - p->ends);
            for (int i = 0; i < 2; i++) {
                moves[i] = end->middle[i];
                moves[2 + i] = end->corner == k ? end->way[i] : 0.0;
                moves[4 + i] = end->corner == next ? end->way[i] : 0.0;
            }
        }
        const double corners[3][2] = {{middle[0], middle[1]}, {here[0], here[1]}, {after[0], after[1]}};
        for (whole q = 0; q < p->points[1];) {
            q += put_points(p, 3, corners, by, q, size * s->law[0], ends);
            if (p->count == POINTS) add_points(p, s, ends, to);
        }
    }
    if (p->count) add_points(p, s, ends, to);
}

/* Asks the law of a contact for the strengths at the points that were collected. */
static void ask_law(Polygons *p, whole contact)
{
    PyObject *answer = p->broken ? NULL : PyObject_CallFunction(p->strengths, "nn", (Py_ssize_t)contact, (Py_ssize_t)p->next);
    p->broken = !answer;
    Py_XDECREF(answer);
}

/* Adds what the passive bolts of one block pull: `BedSprings.pulls`. */
static void add_bolts(const Polygons *p, whole block, const double *slip, double reduction, int running, int sticks,
                      double *out, double *by_slip, double *by_reduction)
{
    const whole u = p->u;
    for (whole i = block * p->bolts; i < (block + 1) * p->bolts; i++) {
        const double *row = p->bolt_rows + i * u, most = reduction * p->capacity[i], drawn = -dot(row, slip, (int)u);
        int full = running ? drawn > p->moves : !sticks && drawn * p->stiff[i] > most;
        double spring = running || full || drawn <= 0.0 ? 0.0 : p->stiff[i], pull = full ? most : spring * drawn;
        for (whole b = 0; b < u; b++) {
            out[b] += pull * row[b], by_reduction[b] += full * p->capacity[i] * row[b];
            for (whole c = 0; c < u; c++) by_slip[b * u + c] -= spring * row[b] * row[c];
        }
    }
}

/* Adds what the contacts and bolts of one block carry, and its slopes. */
static void add_block(Polygons *p, whole block, const double *opening, const double *slip, double reduction,
                      int running, int sticks, double *out, double *by_opening, double *by_slip, double *by_reduction)
{
    static const int SECOND[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const whole u = p->u;
    for (whole k = p->contact[block]; k < p->contact[block + 1]; k++) {
        const double *rows = p->rows + k * 9 * u, *across = rows + 3 * u, *plane = p->plane + 2 * p->first[k];
        const double *law = p->law + 3 * k;
        Asked asked = {.law = law, .reduction = reduction, .running = running, .sticks = sticks};
        double (*field)[3] = asked.field, gap[3];
        whole count = p->first[k + 1] - p->first[k], left, ends;
        for (int i = 0; i < 3; i++) {
            gap[i] = dot(rows + i * u, opening, (int)u), field[0][i] = -gap[i];
            for (int j = 1; j < 3; j++) field[j][i] = dot(rows + (3 * j + i) * u, slip, (int)u);
        }
        for (whole i = 0; i < count; i++) p->gaps[i] = gap[0] + gap[1] * plane[2 * i] + gap[2] * plane[2 * i + 1];
        const double *part = pressed_part(p, plane, count, &left, &ends);
        if (!left) continue;
        Sums sums = {{{0.0}}, {{0.0}}};
        for (whole m = 0; m < ends; m++) memset(p->ends[m].by, 0, sizeof p->ends[m].by);
        int curved = p->strengths && p->curved[k];
        for (p->asks = curved; p->asks >= 0; p->asks--) { /* twice where the law is curved */
            p->next = curved ? 0 : -1;
            if (count == 2) add_line(p, part, &asked, ends, &sums);
            else add_fan(p, part, left, &asked, ends, p->moves_by, &sums);
            if (p->asks) ask_law(p, k);
        }
        /* from moments by 1, ξ and η to the block: out, then the slopes */
        double lifts[3] = {0.0}, opens[9][6] = {{0.0}}, turns[6][6] = {{0.0}};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                lifts[i] += sums.second[0][SECOND[i][j]] * gap[j];
                for (int w = 0; w < 3; w++)
                    for (whole b = 0; b < u; b++) opens[3 * w + i][b] += sums.second[w][SECOND[i][j]] * rows[j * u + b];
                for (int w = 0; w < 2; w++)
                    for (int v = 0; v < 2; v++)
                        for (whole b = 0; b < u; b++)
                            turns[3 * w + i][b] += sums.second[3 + w + v][SECOND[i][j]] * across[(3 * v + j) * u + b];
            }
        for (whole m = 0; m < ends; m++) /* where the part grows its points move, and its shear with them */
            for (whole b = 0; b < u; b++) {
                const End *end = p->ends + m;
                double grows = 0.0;
                for (int i = 0; i < 3; i++) grows += end->by_gap[i] * rows[i * u + b];
                for (int i = 0; i < 6; i++) opens[3 + i][b] -= end->by[i / 3][i % 3] * grows;
            }
        for (whole b = 0; b < u; b++) {
            for (int i = 0; i < 3; i++) out[b] += lifts[i] * rows[i * u + b];
            for (int i = 0; i < 6; i++) {
                out[b] -= sums.first[i / 3][i % 3] * across[i * u + b];
                by_reduction[b] -= sums.first[2 + i / 3][i % 3] * across[i * u + b];
            }
            for (whole c = 0; c < u; c++) {
                for (int i = 0; i < 9; i++) by_opening[b * u + c] += rows[i * u + b] * opens[i][c];
                for (int i = 0; i < 6; i++) by_slip[b * u + c] -= across[i * u + b] * turns[i][c];
            }
        }
    }
    add_bolts(p, block, slip, reduction, running, sticks, out, by_slip, by_reduction);
}

/* pressed(polygons, blocks, opening, slip, reduction, running, sticks, out, by_opening, by_slip, by_reduction): adds to
   them, a row for each of these blocks */
static PyObject *pressed(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 11)) return NULL;
    Polygons *p = PyCapsule_GetPointer(a[0], POLYGONS);
    if (!p) return NULL;
    const whole u = p->u;
    Kept here = {0}, *kept = &here;
    int running = PyObject_IsTrue(a[5]), sticks = PyObject_IsTrue(a[6]), failed = PyErr_Occurred() != NULL;
    const whole *blocks = WHOLES(a[1], -1);
    whole count = failed ? 0 : kept->views[0].len / 8;
    const double *opening = FLOATS(a[2], count * u), *slip = FLOATS(a[3], count * u), *reduction = FLOATS(a[4], count);
    double *out = OUT(a[7], count * u), *by_opening = OUT(a[8], count * u * u), *by_slip = OUT(a[9], count * u * u);
    double *by_reduction = OUT(a[10], count * u);
    for (whole r = 0; !failed && r < count; r++)
        if (blocks[r] < 0 || blocks[r] >= p->blocks) {
            PyErr_SetString(PyExc_ValueError, "there is no such block");
            failed = 1;
        }
    for (whole r = 0; !failed && r < count; r++)
        add_block(p, blocks[r], opening + r * u, slip + r * u, reduction[r], running, sticks, out + r * u,
                  by_opening + r * u * u, by_slip + r * u * u, by_reduction + r * u);
    failed |= p->broken, p->broken = 0;
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* What Newton's method needs of one block: unknowns u / scale and ln λ, which it seeks on a plane. */
typedef struct {
    whole u, block;
    const double *load, *plane, *drag, *held; /* drag: NULL where nothing holds the block back to `held` */
    double offset, scale;
    int sticks;
} Sought;

/* Unbalanced forces and the distance from the plane, (u + 1), with their slopes (u + 1, u + 1); returns λ. */
static double on_plane(Polygons *p, const Sought *s, const double *x, double *out, double *slopes)
{
    whole u = s->u, n = u + 1;
    double at[6], by_opening[36] = {0.0}, by_slip[36] = {0.0}, by_reduction[6] = {0.0};
    double reduction = exp(x[u] < 50.0 ? x[u] : 50.0);
    for (whole i = 0; i < u; i++) at[i] = x[i] * s->scale, out[i] = s->load[i];
    add_block(p, s->block, at, at, reduction, 0, s->sticks, out, by_opening, by_slip, by_reduction);
    for (whole i = 0; i < u; i++) {
        for (whole j = 0; j < u; j++) {
            double slope = by_opening[i * u + j] + by_slip[i * u + j];
            if (s->drag) slope -= s->drag[i * u + j], out[i] -= s->drag[i * u + j] * (at[j] - s->held[j]);
            slopes[i * n + j] = slope * s->scale;
        }
        slopes[i * n + u] = by_reduction[i] * reduction;
    }
    memcpy(slopes + u * n, s->plane, n * sizeof(double));
    out[u] = dot(s->plane, x, (int)n) - s->offset;
    return reduction;
}

/* Solves a small system by elimination with pivots; returns the sign of its determinant, 0 where it is singular. */
static int eliminated(const double *from, const double *right, whole n, double *x)
{
    double a[7][7];
    int sign = 1;
    for (whole i = 0; i < n; i++) {
        memcpy(a[i], from + i * n, n * sizeof(double));
        x[i] = right[i];
    }
    for (whole k = 0; k < n; k++) {
        whole best = k;
        for (whole i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[best][k])) best = i;
        if (!(fabs(a[best][k]) > 0.0) || !isfinite(a[best][k])) return 0;
        for (whole j = k; j < n && best != k; j++) {
            double kept = a[k][j];
            a[k][j] = a[best][j], a[best][j] = kept;
        }
        double right_kept = x[k];
        x[k] = x[best], x[best] = right_kept;
        if ((best != k) != (a[k][k] < 0.0)) sign = -sign;
        for (whole i = k + 1; i < n; i++) {
            double part = a[i][k] / a[k][k];
            for (whole j = k + 1; j < n; j++) a[i][j] -= part * a[k][j];
            x[i] -= part * x[k];
        }
    }
    for (whole k = n - 1; k >= 0; k--) {
        for (whole j = k + 1; j < n; j++) x[k] -= a[k][j] * x[j];
        x[k] /= a[k][k];
    }
    return sign;
}

/* Newton's method of one block from x, which becomes what it found: `newton_rows` and `damped_rows` of bed_path.py. */
static int found_balance(Polygons *p, const Sought *s, double *x, double *slopes, whole most, whole patience,
                         double farthest, double shortest, double balanced, whole *used)
{
    whole n = s->u + 1;
    double out[7], step[7] = {0.0}, base[7], last = INFINITY, length = 1.0;
    memcpy(base, x, n * sizeof(double));
    for (*used = 1; *used <= most; *used += 1) {
        double small = on_plane(p, s, x, out, slopes), now = 0.0, far = 0.0;
        for (whole i = 0; i < n; i++)
            if (!(fabs(out[i]) <= now)) now = fabs(out[i]);
        if (now <= balanced * (small > 1.0 ? small : 1.0)) return 1;
        if (shortest > 0.0) {
            if (now < last * (1.0 - 0.1 * length)) {
                if (!eliminated(slopes, out, n, step)) return 0;
                memcpy(base, x, n * sizeof(double));
                last = now, length = 1.0;
            } else length *= 0.5;
            if (length < shortest) return 0;
        } else {
            if (!(now < (*used - 1 > patience ? last : INFINITY)) || !eliminated(slopes, out, n, step)) return 0;
            memcpy(base, x, n * sizeof(double));
            last = now;
        }
        for (whole i = 0; i < n; i++) {
            if (!(fabs(step[i]) <= far)) far = fabs(step[i]);
            x[i] = base[i] - length * step[i];
        }
        if (!(far < farthest)) return 0;
    }
    *used = most;
    return 0;
}

/* balanced(polygons, blocks, load, planes, offsets, scale, drag, held, sticks, (most, patience, farthest, shortest,
   balanced), x, tangents, sides, settled, used): x is where to start, and then what was found, with unit tangents across
   the planes and the signs of the determinants; drag and held may be empty */
static PyObject *balanced(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 15)) return NULL;
    Polygons *p = PyCapsule_GetPointer(a[0], POLYGONS);
    if (!p) return NULL;
    const whole u = p->u, k = u + 1;
    Kept here = {0}, *kept = &here;
    int sticks = PyObject_IsTrue(a[8]), failed = PyErr_Occurred() != NULL;
    const whole *blocks = WHOLES(a[1], -1);
    whole count = failed ? 0 : kept->views[0].len / 8, used;
    const double *load = FLOATS(a[2], p->blocks * u), *planes = FLOATS(a[3], count * k), *offsets = FLOATS(a[4], count);
    const double *scale = FLOATS(a[5], count), *drag = FLOATS(a[6], -1);
    int dragged = !failed && kept->views[kept->arrays - 1].len > 0;
    if (dragged && kept->views[kept->arrays - 1].len != count * u * u * 8) {
        PyErr_SetString(PyExc_ValueError, "a drag of another size");
        failed = 1;
    }
    const double *held = FLOATS(a[7], dragged ? count * u : -1);
    const double *limits = FLOATS(a[9], 5);
    double *x = OUT(a[10], count * k), *tangents = OUT(a[11], count * k), slopes[49];
    double *sides = OUT(a[12], count);
    char *settled = OUT_BOOLS(a[13], count);
    whole *evaluations = (whole *)OUT(a[14], count);
    for (whole r = 0; !failed && r < count; r++)
        if (blocks[r] < 0 || blocks[r] >= p->blocks) {
            PyErr_SetString(PyExc_ValueError, "there is no such block");
            failed = 1;
        }
    for (whole r = 0; !failed && r < count; r++) {
        const Sought sought = {
            u, blocks[r], load + blocks[r] * u, planes + r * k, dragged ? drag + r * u * u : NULL,
            dragged ? held + r * u : NULL, offsets[r], scale[r], sticks,
        };
        double at[7];
        memcpy(at, x + r * k, k * sizeof(double));
        settled[r] = (char)found_balance(p, &sought, at, slopes, (whole)limits[0], (whole)limits[1],
                                         limits[2], limits[3], limits[4], &used);
        evaluations[r] = used;
        if (!settled[r]) continue;
        memcpy(x + r * k, at, k * sizeof(double));
        double ahead[7] = {0.0}, *tangent = tangents + r * k;
        ahead[u] = 1.0;
        sides[r] = eliminated(slopes, ahead, k, tangent);
        if (sides[r] == 0.0) memset(tangent, 0, k * sizeof(double));
        double length = sqrt(dot(tangent, tangent, (int)k));
        for (whole i = 0; i < k; i++) tangent[i] /= length > 1e-300 ? length : 1e-300;
    }
    failed |= p->broken, p->broken = 0;
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- steps to the static bound of blocks in space (program.py, springs.py, cones.py): a cone for each node pair --------- */

/* What one pair needs within a step: its state, Nesterov & Todd's scaling, and the springs. */
typedef struct {
    double normal, gap, give, soft, mu, weight;
    double w0, w1[2], size;
    double p, over, kappa0, tilt[2], inverse[3], bare, bare_tilt[2];
    double of_normal, of_friction[2];
} Pair;
#define PAIR (whole)(sizeof(Pair) / sizeof(double))

INLINE double above(double value) { return value > 1e-300 ? value : 1e-300; }

INLINE double det3(const double *x) { return above(x[0] * x[0] - x[1] * x[1] - x[2] * x[2]); }

/* W x (sign 1) or W^-1 x (sign -1). */
INLINE void scaled(const Pair *c, const double *x, double sign, double *out)
{
    double along = c->w1[0] * x[1] + c->w1[1] * x[2], by = sign > 0.0 ? c->size : 1.0 / c->size;
    double rest = sign * x[0] + along / (1.0 + c->w0);
    out[0] = by * (c->w0 * x[0] + sign * along);
    out[1] = by * (x[1] + c->w1[0] * rest), out[2] = by * (x[2] + c->w1[1] * rest);
}

INLINE void times3(const double *a, const double *b, double *out)
{
    out[0] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    out[1] = b[0] * a[1] + a[0] * b[1], out[2] = b[0] * a[2] + a[0] * b[2];
}

INLINE void over3(const double *a, const double *b, double *out)
{
    out[0] = (a[0] * b[0] - a[1] * b[1] - a[2] * b[2]) / det3(a);
    out[1] = (b[1] - out[0] * a[1]) / a[0], out[2] = (b[2] - out[0] * a[2]) / a[0];
}

INLINE double brought(double x, double low, double high)
{
    double change = (x < low ? low : x > high ? high : x) - x;
    return change < -high ? -high : change;
}

/* The largest step from a cone's point, at most `most`. */
INLINE double within3(const double *p, const double *s, double most)
{
    double a = s[0] * s[0] - (s[1] * s[1] + s[2] * s[2]), b = p[0] * s[0] - (p[1] * s[1] + p[2] * s[2]), c = det3(p);
    if (b * b >= a * c) {
        double root = sqrt(b * b - a * c), half = -(b + (b >= 0.0 ? root : -root));
        double ends[2] = {half / a, c / half};
        for (int i = 0; i < 2; i++)
            if (ends[i] > 0.0 && ends[i] < most) most = ends[i];
    }
    return s[0] < 0.0 && -p[0] / s[0] < most ? -p[0] / s[0] : most;
}

/* Opening and slips of a pair by the motion of its contact, and back: a force on the contact. */
INLINE void moved_by(const Contacts *c, whole m, const double *r, double *opening, double *slip)
{
    const double *row = c->rows + 3 * m, *tangents = c->slips + 6 * m;
    *opening = row[0] * r[0] + row[1] * r[4] + row[2] * r[5];
    for (int i = 0; i < 2; i++) slip[i] = dot(tangents + 3 * i, r + 1, 3);
}

INLINE void onto(const Contacts *c, whole m, double normal, const double *friction, double *f)
{
    const double *row = c->rows + 3 * m, *tangents = c->slips + 6 * m;
    f[0] += row[0] * normal, f[4] += row[1] * normal, f[5] += row[2] * normal;
    for (int j = 0; j < 3; j++) f[1 + j] += tangents[j] * friction[0] + tangents[3 + j] * friction[1];
}

static const Contacts *of_cones(PyObject *from)
{
    const Contacts *c = PyCapsule_GetPointer(from, CONTACTS);
    if (!c || (c->u == 6 && c->pairs == c->groups)) return c;
    PyErr_SetString(PyExc_ValueError, "not blocks in space");
    return NULL;
}

/* cone_residuals(contacts, give, soft, mu, weight, apart, normal, friction, gap, strength, slip, velocity, load factor,
                  off_normal, off_slip, off_strength, balance) -> (weight . slip, complementarity, worth);
   the forces are added to `balance` */
static PyObject *cone_residuals(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 17)) return NULL;
    const Contacts *c = of_cones(a[0]);
    if (!c) return NULL;
    const whole m = c->pairs;
    Kept here = {0}, *kept = &here;
    double factor = PyFloat_AsDouble(a[12]), work = 0.0, gaps = 0.0, worth = 0.0;
    int failed = PyErr_Occurred() != NULL;
    const double *give = FLOATS(a[1], m), *soft = FLOATS(a[2], m), *mu = FLOATS(a[3], m), *weight = FLOATS(a[4], m);
    const double *apart = FLOATS(a[5], m), *normal = FLOATS(a[6], m), *friction = FLOATS(a[7], 2 * m);
    const double *gap = FLOATS(a[8], m), *q = FLOATS(a[9], 3 * m), *z = FLOATS(a[10], 3 * m);
    const double *x = FLOATS(a[11], 6 * c->blocks);
    double *of_normal = OUT(a[13], m), *of_slip = OUT(a[14], 2 * m), *of_strength = OUT(a[15], 3 * m);
    double *balance = OUT(a[16], 6 * c->blocks);
    for (whole k = 0; !failed && k < c->contacts; k++) {
        double r[6], f[6] = {0.0}, opening, slip[2];
        motion_of(c, k, x, r, 6);
        for (whole i = c->first_group[k]; i < c->first_group[k + 1]; i++) {
            const double *t = friction + 2 * i, *qi = q + 3 * i, *zi = z + 3 * i;
            moved_by(c, i, r, &opening, slip);
            of_normal[i] = give[i] * normal[i] + opening - gap[i] - mu[i] * zi[0];
            worth += fabs(of_normal[i] * normal[i]);
            of_strength[3 * i] = qi[0] - (factor * weight[i] + mu[i] * normal[i] + apart[i]);
            for (int j = 0; j < 2; j++) {
                of_slip[2 * i + j] = soft[i] * t[j] + slip[j] - zi[1 + j];
                of_strength[3 * i + 1 + j] = qi[1 + j] - t[j];
                worth += fabs(of_slip[2 * i + j] * t[j]);
            }
            work += weight[i] * zi[0], gaps += normal[i] * gap[i] + dot(qi, zi, 3);
            onto(c, i, normal[i], t, f);
        }
        push(c, k, f, balance, 6);
    }
    released(kept);
    return failed ? NULL : Py_BuildValue("ddd", work, gaps, worth);
}

/* cone_springs(contacts, give, soft, mu, weight, normal, gap, strength, slip, pairs, stiffness, border) -> corner */
static PyObject *cone_springs(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 12)) return NULL;
    const Contacts *c = of_cones(a[0]);
    if (!c) return NULL;
    const whole m = c->pairs;
    Kept here = {0}, *kept = &here;
    double corner = 0.0;
    int failed = 0;
    const double *give = FLOATS(a[1], m), *soft = FLOATS(a[2], m), *mu = FLOATS(a[3], m), *weight = FLOATS(a[4], m);
    const double *normal = FLOATS(a[5], m), *gap = FLOATS(a[6], m), *q = FLOATS(a[7], 3 * m), *z = FLOATS(a[8], 3 * m);
    Pair *pairs = (Pair *)OUT(a[9], PAIR * m);
    double *out = OUT(a[10], 36 * c->contacts), *border = OUT(a[11], 6 * c->blocks);
    for (whole k = 0; !failed && k < c->contacts; k++) {
        double *s = out + 36 * k, f[6] = {0.0};
        for (int i = 0; i < 36; i++) s[i] = 0.0;
        for (whole i = c->first_group[k]; i < c->first_group[k + 1]; i++) {
            Pair *at = pairs + i;
            const double *qi = q + 3 * i, *zi = z + 3 * i;
            at->normal = normal[i], at->gap = gap[i], at->give = give[i], at->soft = soft[i];
            at->mu = mu[i], at->weight = weight[i];
            double of_q = det3(qi), of_z = det3(zi), rq = 1.0 / sqrt(of_q), rz = 1.0 / sqrt(of_z), u[3], v[3];
            for (int j = 0; j < 3; j++) u[j] = rq * qi[j], v[j] = rz * zi[j];
            double half = (1.0 + dot(u, v, 3)) / 2.0, gamma = sqrt(half > 1e-30 ? half : 1e-30);
            at->w0 = (u[0] + v[0]) / (2.0 * gamma);
            for (int j = 0; j < 2; j++) at->w1[j] = (u[1 + j] - v[1 + j]) / (2.0 * gamma);
            double eta2 = sqrt(of_q / of_z), bent = 2.0 * at->w0 * at->w0 - 1.0, give2 = soft[i] * eta2;
            at->size = sqrt(eta2);
            at->p = 1.0 / (give[i] + gap[i] / normal[i]);
            at->kappa0 = (1.0 + give2 * bent) / (eta2 * (bent + give2));
            at->bare = 1.0 / (eta2 * bent);
            double long1 = sqrt(at->w1[0] * at->w1[0] + at->w1[1] * at->w1[1]);
            double across = eta2 / (1.0 + give2), along = eta2 / (bent + give2), unit[2];
            for (int j = 0; j < 2; j++) {
                at->tilt[j] = -2.0 * at->w0 / (bent + give2) * at->w1[j];
                at->bare_tilt[j] = -2.0 * at->w0 / bent * at->w1[j];
                unit[j] = at->w1[j] / above(long1);
            }
            at->inverse[0] = (along - across) * unit[0] * unit[0] + across;
            at->inverse[1] = (along - across) * unit[0] * unit[1];
            at->inverse[2] = (along - across) * unit[1] * unit[1] + across;
            at->over = 1.0 / (1.0 + mu[i] * mu[i] * at->kappa0 * at->p);
            double pull = mu[i] * at->kappa0 * weight[i] * at->over;
            at->of_normal = at->p * pull;
            for (int j = 0; j < 2; j++) at->of_friction[j] = at->tilt[j] * (weight[i] - mu[i] * at->p * pull);
            corner += weight[i] * at->kappa0 * weight[i] * at->over;
            onto(c, i, at->of_normal, at->of_friction, f);
            /* the pair's stiffness (3, 3), then that of the contact */
            double nn = at->p * at->over, less = mu[i] * nn, D[3][3] = {{nn}}, by[3][6] = {{0.0}};
            D[1][1] = at->inverse[0], D[1][2] = D[2][1] = at->inverse[1], D[2][2] = at->inverse[2];
            for (int j = 0; j < 2; j++) {
                D[0][1 + j] = D[1 + j][0] = -less * at->tilt[j];
                for (int l = 0; l < 2; l++) D[1 + j][1 + l] += mu[i] * less * at->tilt[j] * at->tilt[l];
            }
            const double *row = c->rows + 3 * i, *tangents = c->slips + 6 * i;
            by[0][0] = row[0], by[0][4] = row[1], by[0][5] = row[2];
            for (int j = 0; j < 2; j++)
                for (int l = 0; l < 3; l++) by[1 + j][1 + l] = tangents[3 * j + l];
            for (int h = 0; h < 3; h++) {
                double of[6] = {0.0};
                for (int j = 0; j < 3; j++)
                    for (int l = 0; l < 6; l++) of[l] += D[h][j] * by[j][l];
                for (int j = 0; j < 6; j++)
                    for (int l = 0; l < 6; l++) s[6 * j + l] += by[h][j] * of[l];
            }
        }
        push(c, k, f, border, 6);
    }
    released(kept);
    return failed ? NULL : PyFloat_FromDouble(corner);
}

/* cone_sources(contacts, pairs, to_normal, to_strength, off_normal, off_slip, off_strength, normal, friction, forces)
   -> what is earned; the forces on blocks are added */
static PyObject *cone_sources(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 10)) return NULL;
    const Contacts *c = of_cones(a[0]);
    if (!c) return NULL;
    const whole m = c->pairs;
    Kept here = {0}, *kept = &here;
    double earned = 0.0;
    int failed = 0;
    const Pair *pairs = (const Pair *)FLOATS(a[1], PAIR * m);
    const double *to_normal = FLOATS(a[2], m), *to_strength = FLOATS(a[3], 3 * m), *off_normal = FLOATS(a[4], m);
    const double *off_slip = FLOATS(a[5], 2 * m), *off_strength = FLOATS(a[6], 3 * m);
    double *normal = OUT(a[7], m), *friction = OUT(a[8], 2 * m), *out = OUT(a[9], 6 * c->blocks);
    for (whole k = 0; !failed && k < c->contacts; k++) {
        double f[6] = {0.0};
        for (whole i = c->first_group[k]; i < c->first_group[k + 1]; i++) {
            const Pair *at = pairs + i;
            double x[3], weak[2], *t = friction + 2 * i;
            scaled(at, to_strength + 3 * i, 1.0, x);
            for (int j = 0; j < 3; j++) x[j] += off_strength[3 * i + j];
            for (int j = 0; j < 2; j++) weak[j] = at->soft * x[1 + j] + off_slip[2 * i + j];
            double of_cone = at->kappa0 * x[0] + at->tilt[0] * weak[0] + at->tilt[1] * weak[1];
            double source = to_normal[i] / at->normal - off_normal[i] + at->mu * of_cone;
            double total = at->p * source * at->over, rest = x[0] - at->mu * total;
            normal[i] = total;
            t[0] = at->tilt[0] * rest + x[1] - at->inverse[0] * weak[0] - at->inverse[1] * weak[1];
            t[1] = at->tilt[1] * rest + x[2] - at->inverse[1] * weak[0] - at->inverse[2] * weak[1];
            earned += at->weight * of_cone - at->mu * at->kappa0 * at->weight * total;
            onto(c, i, normal[i], t, f);
        }
        push(c, k, f, out, 6);
    }
    released(kept);
    return failed ? NULL : PyFloat_FromDouble(earned);
}

/* cone_step(contacts, pairs, velocity, load factor, mean normal / mean gap, to_normal, to_strength, off_normal, off_slip,
             off_strength, strength, slip, normal, friction, d_strength, d_gap, d_slip) -> the longest step; `normal` and
   `friction` hold the sources, and then their steps */
static PyObject *cone_step(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 17)) return NULL;
    const Contacts *c = of_cones(a[0]);
    if (!c) return NULL;
    const whole m = c->pairs;
    Kept here = {0}, *kept = &here;
    double factor = PyFloat_AsDouble(a[3]), opens = PyFloat_AsDouble(a[4]), most = INFINITY;
    int failed = PyErr_Occurred() != NULL;
    const Pair *pairs = (const Pair *)FLOATS(a[1], PAIR * m);
    const double *velocity = FLOATS(a[2], 6 * c->blocks), *to_normal = FLOATS(a[5], m);
    const double *to_strength = FLOATS(a[6], 3 * m), *off_normal = FLOATS(a[7], m), *off_slip = FLOATS(a[8], 2 * m);
    const double *off_strength = FLOATS(a[9], 3 * m), *q = FLOATS(a[10], 3 * m), *z = FLOATS(a[11], 3 * m);
    double *normal = OUT(a[12], m), *friction = OUT(a[13], 2 * m), *dq = OUT(a[14], 3 * m), *gap = OUT(a[15], m);
    double *dz = OUT(a[16], 3 * m);
    for (whole k = 0; !failed && k < c->contacts; k++) {
        double r[6], opening, slip[2];
        motion_of(c, k, velocity, r, 6);
        for (whole i = c->first_group[k]; i < c->first_group[k + 1]; i++) {
            const Pair *at = pairs + i;
            double x[3], *t = friction + 2 * i, *qi = dq + 3 * i, *zi = dz + 3 * i;
            moved_by(c, i, r, &opening, slip);
            scaled(at, to_strength + 3 * i, 1.0, x);
            double total = at->p * at->over * (opening - at->mu * (at->tilt[0] * slip[0] + at->tilt[1] * slip[1]));
            double less = at->mu * total;
            normal[i] -= total + factor * at->of_normal;
            t[0] -= at->inverse[0] * slip[0] + at->inverse[1] * slip[1] - at->tilt[0] * less + factor * at->of_friction[0];
            t[1] -= at->inverse[1] * slip[0] + at->inverse[2] * slip[1] - at->tilt[1] * less + factor * at->of_friction[1];
            qi[0] = at->weight * factor + at->mu * normal[i] - off_strength[3 * i];
            for (int j = 0; j < 2; j++) {
                qi[1 + j] = t[j] - off_strength[3 * i + 1 + j];
                zi[1 + j] = off_slip[2 * i + j] + slip[j] + at->soft * t[j];
            }
            zi[0] = at->bare * (x[0] - qi[0]) + at->bare_tilt[0] * zi[1] + at->bare_tilt[1] * zi[2];
            gap[i] = at->gap * opens > at->normal
                         ? off_normal[i] + opening + at->give * normal[i] - at->mu * zi[0]
                         : (to_normal[i] - at->gap * normal[i]) / at->normal;
            if (normal[i] < 0.0 && -at->normal / normal[i] < most) most = -at->normal / normal[i];
            if (gap[i] < 0.0 && -at->gap / gap[i] < most) most = -at->gap / gap[i];
            most = within3(z + 3 * i, zi, within3(q + 3 * i, qi, most));
        }
    }
    released(kept);
    return failed ? NULL : PyFloat_FromDouble(most);
}

/* cone_targets(pairs, strength, slip, d_normal, d_gap, d_strength, d_slip, middle, barrier, length, low, high, of_normal,
                target, to_strength): length < 0: those of Mehrotra's step; else what a step so long still lacks is added */
static PyObject *cone_targets(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 15)) return NULL;
    Kept here = {0}, *kept = &here;
    double barrier = PyFloat_AsDouble(a[8]), length = PyFloat_AsDouble(a[9]);
    double low = PyFloat_AsDouble(a[10]), high = PyFloat_AsDouble(a[11]);
    int failed = PyErr_Occurred() != NULL;
    const Pair *pairs = (const Pair *)FLOATS(a[0], -1);
    const whole m = failed ? 0 : kept->views[0].len / (whole)sizeof(Pair);
    const double *q = FLOATS(a[1], 3 * m), *z = FLOATS(a[2], 3 * m), *normal = FLOATS(a[3], m), *gap = FLOATS(a[4], m);
    const double *dq = FLOATS(a[5], 3 * m), *dz = FLOATS(a[6], 3 * m), *middle = FLOATS(a[7], 3 * m);
    double *of_normal = OUT(a[12], m), *target = OUT(a[13], 3 * m), *to_strength = OUT(a[14], 3 * m);
    for (whole i = 0; !failed && i < m; i++) {
        const Pair *at = pairs + i;
        double u[3], v[3], both[3], own[3], *to = target + 3 * i;
        if (length < 0.0) {
            of_normal[i] = barrier - at->gap * at->normal - normal[i] * gap[i];
            scaled(at, dq + 3 * i, -1.0, u), scaled(at, dz + 3 * i, 1.0, v);
            times3(u, v, both), times3(middle + 3 * i, middle + 3 * i, own);
            for (int j = 0; j < 3; j++) to[j] = -own[j] - both[j];
            to[0] += barrier;
        } else {
            double there = (at->normal + length * normal[i]) * (at->gap + length * gap[i]);
            of_normal[i] += brought(there, low, high);
            for (int j = 0; j < 3; j++) {
                u[j] = q[3 * i + j] + length * dq[3 * i + j];
                v[j] = z[3 * i + j] + length * dz[3 * i + j];
            }
            scaled(at, u, -1.0, both), scaled(at, v, 1.0, own);
            times3(both, own, u);
            double size = sqrt(u[1] * u[1] + u[2] * u[2]);
            double less = brought(u[0] - size, low, high), more = brought(u[0] + size, low, high);
            double turned = 0.5 * (more - less) / above(size);
            to[0] += 0.5 * (less + more), to[1] += turned * u[1], to[2] += turned * u[2];
        }
        over3(middle + 3 * i, to, to_strength + 3 * i);
    }
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* cone_middle(pairs, slip, middle): W z */
static PyObject *cone_middle(PyObject *self, PyObject *const *a, Py_ssize_t n)
{
    if (!enough(n, 3)) return NULL;
    Kept here = {0}, *kept = &here;
    int failed = 0;
    const Pair *pairs = (const Pair *)FLOATS(a[0], -1);
    const whole m = failed ? 0 : kept->views[0].len / (whole)sizeof(Pair);
    const double *z = FLOATS(a[1], 3 * m);
    double *middle = OUT(a[2], 3 * m);
    for (whole i = 0; !failed && i < m; i++) scaled(pairs + i, z + 3 * i, 1.0, middle + 3 * i);
    released(kept);
    return failed ? NULL : Py_NewRef(Py_None);
}

/* -- the module ------------------------------------------------------------------------------------------------------ */

#define FAST(name) {#name, (PyCFunction)(void (*)(void))name, METH_FASTCALL, NULL}
static PyMethodDef METHODS[] = {
    FAST(contacts), FAST(law), FAST(forces), FAST(add_viscous), FAST(stiffness), FAST(couple), FAST(pressed_share), FAST(tangent), FAST(plan),
    FAST(longest_step), FAST(assembled), FAST(fronts), FAST(factored), FAST(solved), FAST(polygons), FAST(pressed),
    FAST(balanced),
    FAST(cone_residuals), FAST(cone_springs), FAST(cone_sources), FAST(cone_step), FAST(cone_targets), FAST(cone_middle),
    {"bind", bind, METH_O, NULL}, {NULL},
};

static struct PyModuleDef MODULE = {PyModuleDef_HEAD_INIT, .m_name = "_kernels", .m_size = -1, .m_methods = METHODS};

PyMODINIT_FUNC PyInit__kernels(void)
{
    PyObject *module = PyModule_Create(&MODULE);
    if (module && PyModule_AddIntConstant(module, "SOURCE", (long)SOURCE) < 0) Py_CLEAR(module);
    return module;
}
