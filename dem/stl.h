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

/* Binary: 80 bytes, a count, 50 bytes a facet. facets may be NULL, to count. Returns the whole ones. */
static inline ptrdiff_t dem__read_binary(const unsigned char *bytes, size_t size, dem__facet *facets, ptrdiff_t *missing) {
    const uint32_t announced = (uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 | (uint32_t)bytes[83] << 24;
    const size_t present = (size - 84) / 50, n = present < announced ? present : announced;
    for (size_t k = 0; facets && k < n; k++) {
        for (int a = 0; a < 12; a++) {
            dem_vec *to = a < 3 ? &facets[k].normal : &facets[k].corner[a / 3 - 1];
            *dem_axis_of(to, a % 3) = dem__little_float(bytes + 84 + 50 * k + 4 * a);
        }
    }
    *missing = (ptrdiff_t)(announced - n);
    return (ptrdiff_t)n;
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
    if (digits && k < length && (text[k] == 'e' || text[k] == 'E')) {
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

/* ASCII: facets are where "facet" stands with its three vertices before the next one; whatever else there is does not matter. */
static inline ptrdiff_t dem__read_ascii(const unsigned char *bytes, size_t size, dem__facet *facets, ptrdiff_t *missing) {
    ptrdiff_t n = 0, begun = 0;
    dem__facet facet;
    int corners = 3, wanted = 0; /* numbers of the present triple still to come */
    dem_vec *to = NULL;
    memset(&facet, 0, sizeof facet);
    for (size_t at = 0, length; (length = dem__word(bytes, size, &at)) > 0; at += length) {
        if (dem__is_word(bytes, at, length, "facet")) {
            begun++;
            corners = 0, wanted = 0;
            facet.normal = dem_vec3(0.0, 0.0, 0.0);
        } else if (dem__is_word(bytes, at, length, "normal")) {
            wanted = 3, to = &facet.normal;
        } else if (dem__is_word(bytes, at, length, "vertex") && corners < 3) {
            wanted = 3, to = &facet.corner[corners];
        } else if (wanted > 0) {
            *dem_axis_of(to, 3 - wanted) = dem__number(bytes + at, length);
            if (--wanted > 0 || to == &facet.normal) continue;
            if (++corners < 3) continue;
            if (facets) facets[n] = facet;
            n++;
        }
    }
    *missing = begun > n ? begun - n : 0;
    return n;
}

/* Many binary files begin with "solid" too: the size decides, then whether there is a facet in the text. */
static inline int dem__is_binary(const unsigned char *bytes, size_t size) {
    ptrdiff_t missing;
    size_t at = 0;
    if (size < 84) return 0;
    dem__read_binary(bytes, size, NULL, &missing);
    if (missing == 0 && (size - 84) / 50 > 0) {
        const uint32_t n = (uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 | (uint32_t)bytes[83] << 24;
        if (size == 84 + 50 * (size_t)n) return 1;
    }
    if (!dem__is_word(bytes, at, dem__word(bytes, size, &at), "solid")) return 1;
    return dem__read_ascii(bytes, size, NULL, &missing) == 0;
}

/* The vertex at a place, an earlier one if that is within `weld`. Vertices hang in chains from the cells of a grid. */
static inline int32_t dem__weld(dem__slot *cells, size_t capacity, int32_t *next, dem_vec *vertex, ptrdiff_t *count, dem_vec p, dem_vec low,
                                double weld, double cell) {
    double from[3], to[3];
    for (int a = 0; a < 3; a++) {
        const double x = dem_axis(p, a) - dem_axis(low, a);
        from[a] = floor((x - weld) / cell), to[a] = floor((x + weld) / cell);
    }
    for (double i = from[0]; i <= to[0]; i++) {
        for (double j = from[1]; j <= to[1]; j++) {
            for (double k = from[2]; k <= to[2]; k++) {
                const uint64_t key = dem__interleave((uint64_t)(i + 2.0)) | dem__interleave((uint64_t)(j + 2.0)) << 1 |
                                     dem__interleave((uint64_t)(k + 2.0)) << 2;
                const dem__slot *slot = dem__find_slot(cells, capacity, key);
                for (int32_t v = slot->key ? slot->value : -1; v >= 0; v = next[v]) {
                    if (dem__length(dem__sub(vertex[v], p)) <= weld) return v;
                }
            }
        }
    }
    const int32_t fresh = (int32_t)(*count)++;
    uint64_t key = 0;
    for (int a = 0; a < 3; a++) key |= dem__interleave((uint64_t)(floor((dem_axis(p, a) - dem_axis(low, a)) / cell) + 2.0)) << a;
    dem__slot *slot = dem__find_slot(cells, capacity, key);
    vertex[fresh] = p;
    next[fresh] = slot->key ? slot->value : -1;
    slot->key = key;
    slot->value = fresh;
    return fresh;
}

/* Edge (a, b) of a triangle. */
static inline void dem__count_edge(dem__slot *edges, size_t capacity, int32_t a, int32_t b) {
    const uint64_t low = (uint64_t)(a < b ? a : b), high = (uint64_t)(a < b ? b : a);
    dem__slot *slot = dem__find_slot(edges, capacity, low << 32 | high);
    slot->key = low << 32 | high; /* never 0, as a < b */
    if (a < b) slot->forward++;
    else slot->backward++;
}

/* Fills an empty mesh, whose arrays have room, from n facets, and the report. slots has room for `capacity` slots, next for 3 n. */
static inline void dem__make_mesh(dem_mesh *m, dem__facet *facets, ptrdiff_t n, double scale, double weld, dem__slot *slots,
                                  size_t capacity, int32_t *next, dem_stl_report *report) {
    dem_vec *vertex = (dem_vec *)(void *)m->vertex, low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dem__scale(-1.0, low);
    ptrdiff_t kept = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        int finite = 1;
        for (int c = 0; c < 9; c++) {
            double *x = dem_axis_of(&facets[k].corner[c / 3], c % 3);
            *x *= scale;
            finite &= fabs(*x) < 1e50;
        }
        if (!finite) {
            report->not_finite++;
            continue;
        }
        facets[kept++] = facets[k];
        for (int c = 0; c < 9; c++) {
            double *l = dem_axis_of(&low, c % 3), *h = dem_axis_of(&high, c % 3), x = dem_axis(facets[k].corner[c / 3], c % 3);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    if (kept == 0) return;
    /* cells: some times the welding distance, and few enough to be numbered by 21 bits an axis */
    const double size = dem__length(dem__sub(high, low)), least = size / 1048576.0;
    weld = weld < size ? weld : size;
    const double cell = 4.0 * weld > least ? 4.0 * weld : (least > 0.0 ? least : 1.0);
    for (ptrdiff_t k = 0; k < kept; k++) {
        int32_t *to = &m->triangle[3 * k];
        for (int c = 0; c < 3; c++) to[c] = dem__weld(slots, capacity, next, vertex, &m->vertices, facets[k].corner[c], low, weld, cell);
    }
    report->low = low, report->high = high;
    memset(slots, 0, capacity * sizeof *slots);
    for (ptrdiff_t k = 0; k < kept; k++) {
        const int32_t t[3] = {m->triangle[3 * k], m->triangle[3 * k + 1], m->triangle[3 * k + 2]};
        dem_vec normal;
        const dem_vec a = vertex[t[0]], b = vertex[t[1]], c = vertex[t[2]];
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || !dem__has_area(a, b, c, &normal)) {
            report->degenerate++;
            continue;
        }
        const int32_t first = t[0] < t[1] ? (t[0] < t[2] ? t[0] : t[2]) : (t[1] < t[2] ? t[1] : t[2]);
        const int32_t last = t[0] > t[1] ? (t[0] > t[2] ? t[0] : t[2]) : (t[1] > t[2] ? t[1] : t[2]);
        const uint64_t middle = (uint64_t)t[0] + (uint64_t)t[1] + (uint64_t)t[2] - (uint64_t)first - (uint64_t)last;
        /* three numbers to a key that others share only by a chance of 2^-64 a pair */
        const uint64_t key = dem__scramble(dem__scramble((uint64_t)first + 1) + dem__scramble(middle + 1) * 3 + (uint64_t)last) | 1;
        dem__slot *slot = dem__find_slot(slots, capacity, key);
        if (slot->key) {
            report->duplicate++;
            continue;
        }
        slot->key = key;
        const dem_vec twice = dem__area(a, b, c), given = facets[k].normal;
        const double length = dem__length(given);
        if (dem__positive(length) && dem__dot(given, normal) < 0.5 * length) report->wrong_normals++;
        report->area += 0.5 * dem__length(twice);
        report->volume += dem__dot(dem__sub(a, low), twice) / 6.0;
        memcpy(&m->triangle[3 * m->triangles++], t, sizeof t);
    }
    memset(slots, 0, capacity * sizeof *slots);
    for (ptrdiff_t k = 0; k < 3 * m->triangles; k++)
        dem__count_edge(slots, capacity, m->triangle[k], m->triangle[k % 3 == 2 ? k - 2 : k + 1]);
    for (size_t k = 0; k < capacity; k++) {
        const int32_t f = slots[k].forward, b = slots[k].backward;
        report->open_edges += f + b == 1;
        report->nonmanifold += f + b > 2;
        report->inconsistent += f + b == 2 && f != b;
    }
}

DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld, const dem_allocator *allocator, dem_mesh *mesh,
                                dem_stl_report *report) {
    const unsigned char *text = (const unsigned char *)bytes;
    dem_stl_report found;
    dem_allocator memory;
    if (!mesh) return DEM_BAD_ARGUMENT;
    memset(mesh, 0, sizeof *mesh);
    memset(&found, 0, sizeof found);
    if (report) *report = found;
    if ((size > 0 && !bytes) || !dem__positive(scale) || !dem__not_negative(weld)) return DEM_BAD_ARGUMENT;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;

    found.binary = dem__is_binary(text, size);
    found.facets = found.binary ? dem__read_binary(text, size, NULL, &found.missing) : dem__read_ascii(text, size, NULL, &found.missing);
    if (report) *report = found;
    if (found.facets == 0) return DEM_BAD_DATA;
    if (found.facets > INT32_MAX / 12) return DEM_TOO_MANY;
    const size_t n = (size_t)found.facets;
    size_t capacity = 64;
    while (capacity < 6 * n) capacity *= 2;
    const size_t scratch = n * sizeof(dem__facet) + capacity * sizeof(dem__slot) + 3 * n * sizeof(int32_t);
    mesh->bytes = 3 * n * sizeof(dem_vec) + 3 * n * sizeof(int32_t);
    mesh->allocator = memory;
    mesh->block = memory.fn(memory.user, NULL, 0, mesh->bytes);
    dem__facet *facets = mesh->block ? (dem__facet *)memory.fn(memory.user, NULL, 0, scratch) : NULL;
    if (!facets) {
        dem_free_mesh(mesh);
        return DEM_OUT_OF_MEMORY;
    }
    dem__slot *slots = (dem__slot *)(void *)(facets + n);
    int32_t *next = (int32_t *)(void *)(slots + capacity);
    memset(slots, 0, capacity * sizeof *slots);
    mesh->vertex = (double *)mesh->block;
    mesh->triangle = (int32_t *)(void *)(mesh->vertex + 9 * n);
    if (found.binary) dem__read_binary(text, size, facets, &found.missing);
    else dem__read_ascii(text, size, facets, &found.missing);
    dem__make_mesh(mesh, facets, found.facets, scale, weld, slots, capacity, next, &found);
    memory.fn(memory.user, facets, scratch, 0);
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
