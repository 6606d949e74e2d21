static inline uint64_t dem__scramble(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline dem__slot *dem__find_slot(dem__slot *slots, size_t capacity, uint64_t key) {
    size_t at = (size_t)dem__scramble(key) & (capacity - 1);
    while (slots[at].key != 0 && slots[at].key != key) at = (at + 1) & (capacity - 1);
    return &slots[at];
}

/* What a facet is before welding: normal, then three corners. */
typedef struct dem__facet {
    dem_vec normal, corner[3];
} dem__facet;

static inline double dem__little_float(const unsigned char *byte) {
    const uint32_t bits = (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* The count in a binary file's head, and how many facets have room behind it. */
typedef struct dem__binary_size {
    size_t announced, present, rest; /* rest: bytes behind the last facet that has room */
} dem__binary_size;
static inline dem__binary_size dem__size_of_binary(const unsigned char *bytes, size_t size) {
    dem__binary_size s;
    s.announced = (size_t)((uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 | (uint32_t)bytes[83] << 24);
    s.present = (size - 84) / 50, s.rest = (size - 84) % 50;
    return s;
}

/* The facets that are read: where count and length disagree, those that end with the file, else those that the count announces. */
static inline size_t dem__facets_of_binary(const dem__binary_size *s) {
    return s->announced < s->present && s->rest > 0 ? s->announced : s->present;
}

/* Counts what a binary file holds and misses. */
static inline void dem__count_binary(const unsigned char *bytes, size_t size, dem_stl_report *report) {
    const dem__binary_size s = dem__size_of_binary(bytes, size);
    const size_t n = dem__facets_of_binary(&s), missing = s.announced > n ? s.announced - n : 0;
    report->facets = (ptrdiff_t)n;
    report->missing = missing < PTRDIFF_MAX ? (ptrdiff_t)missing : PTRDIFF_MAX;
    report->unannounced = n > s.announced ? (ptrdiff_t)(n - s.announced) : 0;
    report->surplus = missing > 0 ? 0 : (ptrdiff_t)(size - 84 - 50 * n);
}

/* Reads facet k of a binary file: normal, three corners, two bytes. */
static inline void dem__read_facet(const unsigned char *bytes, size_t k, dem__facet *facet) {
    for (int a = 0; a < 12; a++) {
        dem_vec *to = a < 3 ? &facet->normal : &facet->corner[a / 3 - 1];
        *dem_axis_of(to, a % 3) = dem__little_float(bytes + 84 + 50 * k + 4 * a);
    }
}

/* Tells whether numbers are coordinates: three in four facets have corners of 0 or between 1e-15 and 1e15. Of other bytes (compressed,
   with the other byte order, two bytes a letter) nearly none have. */
static inline int dem__has_coordinates(const unsigned char *bytes, size_t size) {
    const dem__binary_size s = dem__size_of_binary(bytes, size);
    const size_t n = dem__facets_of_binary(&s);
    size_t good = 0;
    for (size_t k = 0; k < n; k++) {
        dem__facet f;
        int fits = 1;
        dem__read_facet(bytes, k, &f);
        for (int c = 0; c < 9; c++) {
            const double x = fabs(dem_axis(f.corner[c / 3], c % 3));
            fits &= x == 0.0 || (x > 1e-15 && x < 1e15);
        }
        good += (size_t)fits;
    }
    return good > 0 && good >= n - n / 4;
}

/* The next word of a text: blanks of any kind part them. Returns its length, 0 at the end. */
static inline size_t dem__word(const unsigned char *bytes, size_t size, size_t *at) {
    size_t length = 0;
    while (*at < size && bytes[*at] <= ' ') ++*at;
    while (*at + length < size && bytes[*at + length] > ' ') length++;
    return length;
}

static inline int dem__is_word(const unsigned char *bytes, size_t at, size_t length, const char *name) {
    size_t k = 0;
    for (; name[k]; k++) {
        const unsigned char c = k < length ? bytes[at + k] : 0;
        if ((c >= 'A' && c <= 'Z' ? c + 32 : c) != (unsigned char)name[k]) return 0;
    }
    return k == length;
}

/* A decimal number, free of the locale; within an ulp or two. NaN if it is none. */
static inline double dem__number(const unsigned char *text, size_t length) {
    size_t k = 0;
    int digits = 0, point = 0, exponent = 0, down = 0;
    uint64_t whole = 0; /* the first 18 digits */
    const int minus = length > 0 && text[0] == '-';
    if (length > 0 && (text[0] == '-' || text[0] == '+')) k++;
    for (; k < length && ((text[k] >= '0' && text[k] <= '9') || (text[k] == '.' && !point)); k++) {
        if (text[k] == '.') {
            point = 1;
            continue;
        }
        if (whole < 100000000000000000u) whole = 10u * whole + (uint64_t)(text[k] - '0'), exponent -= point;
        else exponent += !point;
        digits++;
    }
    if (digits && k < length && (text[k] == 'e' || text[k] == 'E' || text[k] == 'd' || text[k] == 'D')) { /* d: Fortran's */
        int power = 0, any = 0;
        k++;
        if (k < length && (text[k] == '-' || text[k] == '+')) down = text[k++] == '-';
        for (; k < length && text[k] >= '0' && text[k] <= '9'; k++, any = 1) power = power < 10000 ? 10 * power + (text[k] - '0') : power;
        if (!any) return (double)NAN;
        exponent += down ? -power : power;
    }
    if (!digits || k != length) return (double)NAN;
    double ten = 1.0, base = 10.0; /* exact up to 10^22 */
    if (exponent < -400 || exponent > 400) exponent = exponent < 0 ? -400 : 400;
    for (int e = exponent < 0 ? -exponent : exponent; e > 0; e >>= 1, base *= base) ten *= e & 1 ? base : 1.0;
    const double value = whole == 0 ? 0.0 : (exponent < 0 ? (double)whole / ten : (double)whole * ten);
    return minus ? -value : value;
}

/* ---- text ---- */

enum { DEM__CORNERS_MAX = 64 }; /* of one facet; with more it counts as missing */

/* A text that is being read, and the facet that the reading is in. */
typedef struct dem__stl_text {
    const unsigned char *bytes;
    size_t size, at;
    dem__facet *out; /* where triangles go; NULL: they are counted only */
    ptrdiff_t triangles, polygons, missing;
    int begun, ended;                        /* the lines "solid" and "endsolid" */
    int inside, loops, corners, wanted, bad; /* in a facet: loops and corners so far, numbers to come, is it garbled */
    dem_vec normal, corner[DEM__CORNERS_MAX], number;
} dem__stl_text;

/* Does a word begin with a name, as solid_name does? */
static inline int dem__begins_with(const unsigned char *bytes, size_t at, size_t length, const char *name) {
    const size_t n = strlen(name);
    return length >= n && dem__is_word(bytes, at, n, name);
}

/* Goes to the end of a line, whose words are a name or a comment; not if a facet ends there: then all stands in one line. */
static inline void dem__skip_line(dem__stl_text *t, size_t length) {
    size_t end = t->at + length, word;
    while (end < t->size && t->bytes[end] != '\n' && t->bytes[end] != '\r') end++;
    for (size_t at = t->at + length; (word = dem__word(t->bytes, end, &at)) > 0; at += word) {
        if (!dem__is_word(t->bytes, at, word, "endfacet")) continue;
        t->at += length;
        return;
    }
    t->at = end;
}

/* Returns a corner from which a fan of triangles covers a polygon, -1 if there is none. */
static inline int dem__fan_start(const dem_vec *corner, int n) {
    dem_vec whole = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 1; k + 1 < n; k++)
        whole = dem__add(whole, dem__cross(dem__sub(corner[k], corner[0]), dem__sub(corner[k + 1], corner[0])));
    const double size = dem__dot(whole, whole);
    if (n == 3 || size != size) return 0; /* what is not a number is counted as such */
    for (int start = 0; start < n; start++) {
        int covers = 1;
        for (int k = 1; k + 1 < n && covers; k++) {
            const dem_vec a = corner[start], b = corner[(start + k) % n], c = corner[(start + k + 1) % n];
            covers = dem__dot(dem__cross(dem__sub(b, a), dem__sub(c, a)), whole) >= -1e-9 * size;
        }
        if (covers) return start;
    }
    return -1;
}

/* Ends the facet that the reading is in; its triangles are kept if it is whole. */
static inline void dem__end_facet(dem__stl_text *t) {
    const int n = t->corners, start = t->inside && !t->bad && t->wanted == 0 && n >= 3 ? dem__fan_start(t->corner, n) : -1;
    if (!t->inside) return;
    t->inside = 0;
    if (start < 0) {
        t->missing++;
        return;
    }
    for (int k = 1; k + 1 < n; k++, t->triangles++) {
        if (!t->out) continue;
        dem__facet *f = &t->out[t->triangles];
        f->normal = t->normal;
        f->corner[0] = t->corner[start], f->corner[1] = t->corner[(start + k) % n], f->corner[2] = t->corner[(start + k + 1) % n];
    }
    t->polygons += n > 3;
}

static inline void dem__begin_facet(dem__stl_text *t) {
    dem__end_facet(t);
    t->inside = 1;
    t->loops = t->corners = t->wanted = t->bad = 0;
    t->normal = dem_vec3(0.0, 0.0, 0.0);
}

/* Reads one word of a facet, which may be the last of three numbers. */
static inline void dem__read_word_of_facet(dem__stl_text *t, size_t length) {
    const unsigned char *b = t->bytes;
    if (dem__is_word(b, t->at, length, "normal")) t->bad |= t->wanted > 0 || t->corners > 0, t->wanted = 6;
    else if (dem__is_word(b, t->at, length, "vertex")) t->bad |= t->wanted > 0 || t->corners == DEM__CORNERS_MAX, t->wanted = 3;
    else if (dem__is_word(b, t->at, length, "outer")) t->bad |= ++t->loops > 1; /* a hole in a face */
    else if (dem__is_word(b, t->at, length, "loop") || dem__is_word(b, t->at, length, "endloop")) t->bad |= t->wanted > 0;
    else if (t->wanted > 0) {
        *dem_axis_of(&t->number, (6 - t->wanted) % 3) = dem__number(b + t->at, length);
        t->wanted--;
        if (t->wanted == 3) t->normal = t->number, t->wanted = 0;
        else if (t->wanted == 0 && !t->bad) t->corner[t->corners++] = t->number;
    } else t->bad = 1;
}

/* Reads a text: facets stand between "facet" and "endfacet", or the next "facet"; names and comments do not matter. */
static inline void dem__read_text(const unsigned char *bytes, size_t size, dem__facet *facets, dem_stl_report *report) {
    dem__stl_text t;
    memset(&t, 0, sizeof t);
    t.bytes = bytes, t.size = size, t.out = facets;
    t.at = size >= 3 && bytes[0] == 0xef && bytes[1] == 0xbb && bytes[2] == 0xbf ? 3 : 0; /* byte-order mark */
    for (size_t length; (length = dem__word(bytes, size, &t.at)) > 0;) {
        const size_t at = t.at;
        if (bytes[at] == '#' || dem__begins_with(bytes, at, length, "//")) dem__skip_line(&t, length);
        else if (dem__is_word(bytes, at, length, "facet")) dem__begin_facet(&t), t.ended = 0, t.at += length;
        else if (dem__is_word(bytes, at, length, "endfacet")) t.missing += !t.inside, dem__end_facet(&t), t.at += length;
        else if (dem__begins_with(bytes, at, length, "endsolid") || (!t.inside && dem__is_word(bytes, at, length, "end")))
            dem__end_facet(&t), t.ended = 1, dem__skip_line(&t, length);
        else if (t.inside) dem__read_word_of_facet(&t, length), t.at += length;
        else if (dem__begins_with(bytes, at, length, "solid")) t.begun = 1, t.ended = 0, dem__skip_line(&t, length);
        else t.at += length;
    }
    if (t.inside || (t.begun && !t.ended)) t.missing++; /* it breaks off */
    report->facets = t.triangles, report->missing = t.missing, report->polygons = t.polygons;
}

/* ---- what a file is ---- */

enum { DEM__STL_UNKNOWN, DEM__STL_TEXT, DEM__STL_BINARY };

/* Tells by what the bytes are, as heads lie: a text has nearly no control characters, a binary file the length that its count says. Where
   the two disagree, what is read must look like coordinates. */
static inline int dem__kind_of_stl(const unsigned char *bytes, size_t size) {
    dem_stl_report found;
    size_t controls = 0;
    int whole = 0;
    memset(&found, 0, sizeof found);
    for (size_t k = 0; k < size; k++) controls += bytes[k] < ' ' && !(bytes[k] >= '\t' && bytes[k] <= '\r');
    const int is_text = controls <= size / 20;
    if (size >= 84) {
        const dem__binary_size s = dem__size_of_binary(bytes, size);
        whole = s.present > 0 && s.present == s.announced && s.rest == 0;
    }
    if (is_text && !whole) return DEM__STL_TEXT;
    if (whole || is_text || (size >= 84 && dem__has_coordinates(bytes, size))) {
        if (is_text) dem__read_text(bytes, size, NULL, &found);
        return found.facets > 0 ? DEM__STL_TEXT : DEM__STL_BINARY;
    }
    dem__read_text(bytes, size, NULL, &found); /* padded with zeros, or damaged */
    return found.facets > 0 ? DEM__STL_TEXT : DEM__STL_UNKNOWN;
}

static inline void dem__count_facets(const unsigned char *bytes, size_t size, dem_stl_report *report) {
    const int kind = dem__kind_of_stl(bytes, size);
    report->binary = kind == DEM__STL_BINARY;
    if (kind == DEM__STL_BINARY) dem__count_binary(bytes, size, report);
    if (kind == DEM__STL_TEXT) dem__read_text(bytes, size, NULL, report);
}

/* ---- from facets to a mesh ---- */

/* What a mesh is made in. */
typedef struct dem__workshop {
    dem__facet *facets;
    ptrdiff_t n;
    dem__slot *slots; /* `capacity` of them */
    size_t capacity;
    int32_t *next; /* 3 n: the next vertex of a cell; then the corners of triangles without area */
    ptrdiff_t slivers;
    double weld, cell; /* cell: 0 to tell vertices by their very coordinates */
} dem__workshop;

static inline uint64_t dem__key_of_cell(const dem__workshop *s, const double *cell) {
    uint64_t key = 0, bits;
    for (int a = 0; a < 3; a++) {
        const double v = (s->cell > 0.0 ? floor(cell[a] / s->cell) : cell[a]) + 0.0; /* no -0 */
        memcpy(&bits, &v, sizeof bits);
        key = dem__scramble(key * 3 + bits + 1);
    }
    return key | 1;
}

/* Returns the vertex at a place, an earlier one if that is within `weld`. Vertices hang in chains from the cells of a grid, which are four
   times as wide as that: few have room in one, wherever the others are. */
static inline int32_t dem__weld(dem__workshop *s, dem_vec *vertex, ptrdiff_t *count, dem_vec p) {
    for (int side = 0; side < (s->cell > 0.0 ? 8 : 1); side++) {
        double place[3];
        int seen = 0;
        for (int a = 0; a < 3; a++) {
            const double low = dem_axis(p, a) - s->weld, high = dem_axis(p, a) + s->weld;
            place[a] = side >> a & 1 ? high : low;
            seen |= (side >> a & 1) && s->cell > 0.0 && floor(low / s->cell) == floor(high / s->cell); /* one cell for both sides */
        }
        if (seen) continue;
        const dem__slot *slot = dem__find_slot(s->slots, s->capacity, dem__key_of_cell(s, place));
        for (int32_t v = slot->key ? slot->value : -1; v >= 0; v = s->next[v]) {
            if (dem__length(dem__sub(vertex[v], p)) <= s->weld) return v;
        }
    }
    const int32_t fresh = (int32_t)(*count)++;
    const double own[3] = {p.x, p.y, p.z};
    const uint64_t key = dem__key_of_cell(s, own);
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, key);
    vertex[fresh] = p;
    s->next[fresh] = slot->key ? slot->value : -1;
    slot->key = key;
    slot->value = fresh;
    return fresh;
}

static inline dem__slot *dem__stl_edge(dem__workshop *s, int32_t a, int32_t b) {
    const uint64_t low = (uint64_t)(a < b ? a : b), high = (uint64_t)(a < b ? b : a);
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, low << 32 | high);
    slot->key = low << 32 | high; /* never 0, as a < b */
    return slot;
}

/* Counts the three edges of a triangle. */
static inline void dem__count_edges_of(dem__workshop *s, const int32_t *t) {
    for (int e = 0; e < 3; e++) {
        const int32_t a = t[e], b = t[(e + 1) % 3];
        dem__slot *slot = dem__stl_edge(s, a, b);
        if (a < b) slot->forward++;
        else slot->backward++;
    }
}

/* Tells how many edges of a triangle have one other, which runs the other way. */
static inline int dem__closes(dem__workshop *s, const int32_t *t) {
    int closed = 0;
    for (int e = 0; e < 3; e++) {
        const dem__slot *slot = dem__stl_edge(s, t[e], t[(e + 1) % 3]);
        const int32_t along = t[e] < t[(e + 1) % 3] ? slot->forward : slot->backward;
        closed += along == 0 && slot->forward + slot->backward == 1;
    }
    return closed;
}

/* Triangles without area close what is open where one long edge lies on two short ones: there is no hole. A fan of them closes one after
   the other; sixteen passes to and fro are enough for any order that a program writes. */
static inline void dem__close_junctions(dem__workshop *s) {
    int changed = 1;
    for (int pass = 0; pass < 16 && changed; pass++) {
        changed = 0;
        for (ptrdiff_t k = 0; k < s->slivers; k++) {
            int32_t *t = &s->next[3 * (pass % 2 ? s->slivers - 1 - k : k)];
            if (t[0] < 0 || dem__closes(s, t) < 2) continue;
            dem__count_edges_of(s, t);
            t[0] = -1;
            changed = 1;
        }
    }
}

/* Scales the facets and leaves out those that are not finite. Returns how many are left, and the box that holds them. */
static inline ptrdiff_t dem__keep_finite(dem__workshop *s, double scale, dem_stl_report *report) {
    dem_vec low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dem__scale(-1.0, low);
    ptrdiff_t kept = 0;
    for (ptrdiff_t k = 0; k < s->n; k++) {
        dem__facet f = s->facets[k];
        int finite = 1;
        for (int c = 0; c < 9; c++) {
            double *x = dem_axis_of(&f.corner[c / 3], c % 3);
            *x *= scale;
            finite &= fabs(*x) < 1e50;
        }
        report->not_finite += !finite;
        if (!finite) continue;
        s->facets[kept++] = f;
        for (int c = 0; c < 9; c++) {
            double *l = dem_axis_of(&low, c % 3), *h = dem_axis_of(&high, c % 3), x = dem_axis(f.corner[c / 3], c % 3);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    if (kept > 0) report->low = low, report->high = high;
    return kept;
}

/* Have the three corners been seen before, in whatever order? */
static inline int dem__is_duplicate(dem__workshop *s, const int32_t *t) {
    const int32_t first = t[0] < t[1] ? (t[0] < t[2] ? t[0] : t[2]) : (t[1] < t[2] ? t[1] : t[2]);
    const int32_t last = t[0] > t[1] ? (t[0] > t[2] ? t[0] : t[2]) : (t[1] > t[2] ? t[1] : t[2]);
    const uint64_t middle = (uint64_t)t[0] + (uint64_t)t[1] + (uint64_t)t[2] - (uint64_t)first - (uint64_t)last;
    /* three numbers to a key that others share only by a chance of 2^-64 a pair */
    const uint64_t key = dem__scramble(dem__scramble((uint64_t)first + 1) + dem__scramble(middle + 1) * 3 + (uint64_t)last) | 1;
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, key);
    if (slot->key) return 1;
    slot->key = key;
    return 0;
}

/* Keeps the triangles that have an area and are new; measures them. */
static inline void dem__keep_triangles(dem__workshop *s, dem_mesh *m, ptrdiff_t n, dem_stl_report *report) {
    const dem_vec *vertex = (const dem_vec *)(const void *)m->vertex;
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t t[3] = {m->triangle[3 * k], m->triangle[3 * k + 1], m->triangle[3 * k + 2]};
        const dem_vec a = vertex[t[0]], b = vertex[t[1]], c = vertex[t[2]];
        const int corners = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        dem_vec normal;
        if (!corners || !dem__has_area(a, b, c, &normal)) {
            report->degenerate++;
            if (corners) memcpy(&s->next[3 * s->slivers++], t, sizeof t);
            continue;
        }
        if (dem__is_duplicate(s, t)) {
            report->duplicate++;
            continue;
        }
        const dem_vec twice = dem__area(a, b, c), given = s->facets[k].normal;
        const double length = dem__length(given);
        if (dem__positive(length) && dem__dot(given, normal) < 0.5 * length) report->wrong_normals++;
        report->area += 0.5 * dem__length(twice);
        report->volume += dem__dot(dem__sub(a, report->low), twice) / 6.0;
        memcpy(&m->triangle[3 * m->triangles++], t, sizeof t);
    }
}

static inline void dem__count_edges(dem__workshop *s, const dem_mesh *m, dem_stl_report *report) {
    for (ptrdiff_t k = 0; k < m->triangles; k++) dem__count_edges_of(s, &m->triangle[3 * k]);
    dem__close_junctions(s);
    for (size_t k = 0; k < s->capacity; k++) {
        const int32_t f = s->slots[k].forward, b = s->slots[k].backward;
        report->open_edges += f + b == 1;
        report->nonmanifold += f + b > 2;
        report->inconsistent += f + b == 2 && f != b;
    }
}

/* Fills an empty mesh, whose arrays have room, and the report. */
static inline void dem__make_mesh(dem_mesh *m, dem__workshop *s, double scale, double weld, dem_stl_report *report) {
    const ptrdiff_t n = dem__keep_finite(s, scale, report);
    if (n == 0) return;
    const double size = dem__length(dem__sub(report->high, report->low));
    s->weld = weld < size ? weld : size;
    s->cell = 4.0 * s->weld;
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    for (ptrdiff_t k = 0; k < 3 * n; k++)
        m->triangle[k] = dem__weld(s, (dem_vec *)(void *)m->vertex, &m->vertices, s->facets[k / 3].corner[k % 3]);
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    dem__keep_triangles(s, m, n, report);
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    dem__count_edges(s, m, report);
}

DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld, const dem_allocator *allocator, dem_mesh *mesh,
                                dem_stl_report *report) {
    const unsigned char *text = (const unsigned char *)bytes;
    dem_stl_report found;
    dem_allocator memory;
    dem__workshop shop;
    if (!mesh) return DEM_BAD_ARGUMENT;
    memset(mesh, 0, sizeof *mesh);
    memset(&found, 0, sizeof found);
    memset(&shop, 0, sizeof shop);
    if (report) *report = found;
    if ((size > 0 && !bytes) || !dem__positive(scale) || !dem__not_negative(weld)) return DEM_BAD_ARGUMENT;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;
    if (!memory.fn) return DEM_BAD_ARGUMENT;

    dem__count_facets(text, size, &found);
    if (report) *report = found;
    if (found.facets == 0) return DEM_BAD_DATA;
    if (found.facets > INT32_MAX / 12) return DEM_TOO_MANY;
    const size_t n = (size_t)found.facets;
    shop.n = found.facets;
    for (shop.capacity = 64; shop.capacity < 6 * n;) shop.capacity *= 2;
    const size_t scratch = n * sizeof(dem__facet) + shop.capacity * sizeof(dem__slot) + 3 * n * sizeof(int32_t);
    mesh->bytes = 3 * n * sizeof(dem_vec) + 3 * n * sizeof(int32_t);
    mesh->allocator = memory;
    mesh->block = memory.fn(memory.user, NULL, 0, mesh->bytes);
    shop.facets = mesh->block ? (dem__facet *)memory.fn(memory.user, NULL, 0, scratch) : NULL;
    if (!shop.facets) {
        dem_free_mesh(mesh);
        return DEM_OUT_OF_MEMORY;
    }
    shop.slots = (dem__slot *)(void *)(shop.facets + n);
    shop.next = (int32_t *)(void *)(shop.slots + shop.capacity);
    mesh->vertex = (double *)mesh->block;
    mesh->triangle = (int32_t *)(void *)(mesh->vertex + 9 * n);
    if (!found.binary) dem__read_text(text, size, shop.facets, &found);
    for (size_t k = 0; k < n && found.binary; k++) dem__read_facet(text, k, &shop.facets[k]);
    dem__make_mesh(mesh, &shop, scale, weld, &found);
    memory.fn(memory.user, shop.facets, scratch, 0);
    if (report) *report = found;
    if (mesh->triangles > 0) return DEM_OK;
    dem_free_mesh(mesh);
    return DEM_BAD_DATA;
}

DEM_API void dem_free_mesh(dem_mesh *mesh) {
    if (!mesh) return;
    if (mesh->block) mesh->allocator.fn(mesh->allocator.user, mesh->block, mesh->bytes, 0);
    memset(mesh, 0, sizeof *mesh);
}
