/* steady.h: means in time, and whether they are means of anything: a curve that still climbs has none. */
#ifndef RIDDLE_STEADY_H
#define RIDDLE_STEADY_H

#include <math.h>
#include <stdbool.h>

enum { STEADY_BLOCKS = 8 };

typedef struct steady_mean {
    double mean, error; /* standard error from blocks, NaN for fewer than two values a block */
    double drift;       /* change over the whole time of a line through the blocks */
    bool
        is_steady; /* that line is level within its scatter (Student's t, 99.5 %), or its drift is below 1
                      % of the mean */
} steady_mean;

/* Of n values at equal times. Blocks are long enough to be independent where a single value is not. */
static inline steady_mean steady_mean_of(const double *value, int n) {
    steady_mean s = {(double)NAN, (double)NAN, (double)NAN, false};
    double sum = 0.0, square = 0.0, slope = 0.0, spread = 0.0, left = 0.0, block[STEADY_BLOCKS];
    for (int k = 0; k < n; k++) sum += value[k];
    if (n > 0) s.mean = sum / n;
    if (n < 2 * STEADY_BLOCKS) return s;
    sum = 0.0;
    for (int b = 0; b < STEADY_BLOCKS; b++) {
        const int from = b * n / STEADY_BLOCKS, to = (b + 1) * n / STEADY_BLOCKS;
        double mean = 0.0;
        for (int k = from; k < to; k++) mean += value[k] / (to - from);
        block[b] = mean;
        sum += mean, square += mean * mean;
    }
    s.error = sqrt(fmax(square - sum * sum / STEADY_BLOCKS, 0.0) / (STEADY_BLOCKS - 1) / STEADY_BLOCKS);
    for (int b = 0; b < STEADY_BLOCKS; b++) {
        const double x = b - 0.5 * (STEADY_BLOCKS - 1);
        slope += x * block[b], spread += x * x;
    }
    slope /= spread;
    for (int b = 0; b < STEADY_BLOCKS; b++) {
        const double miss = block[b] - sum / STEADY_BLOCKS - slope * (b - 0.5 * (STEADY_BLOCKS - 1));
        left += miss * miss;
    }
    s.drift = slope * STEADY_BLOCKS;
    const double error = sqrt(left / (STEADY_BLOCKS - 2) / spread), student = 4.317; /* of 6 degrees of freedom */
    s.is_steady = fabs(slope) <= student * error || fabs(s.drift) <= 0.01 * fabs(s.mean);
    return s;
}

enum { STEADY_PARTS = 20 };

typedef struct steady_flow {
    double rate, error; /* standard error; NaN where there is no rate */
    bool is_enough;     /* three events a part */
    bool is_steady;     /* the halves differ by less than four errors of that, or by 4 % */
} steady_flow;

/* Rate of what adds up: sum[k] after the event at time[k], between two events, from equal parts of the time. */
static inline steady_flow steady_flow_of(const double *time, const double *sum, int first, int last) {
    steady_flow f = {(double)NAN, (double)NAN, last - first >= 3 * STEADY_PARTS, false};
    const double n = STEADY_PARTS;
    double square = 0.0, half[2] = {0.0, 0.0};
    if (!f.is_enough) return f;
    const double from = time[first], size = (time[last] - from) / n;
    for (int b = 0, k = first; b < STEADY_PARTS; b++) {
        const int begin = k;
        while (k < last && time[k] < from + (b + 1) * size) k++;
        const double rate = (sum[k] - sum[begin]) / size;
        square += rate * rate, half[2 * b / STEADY_PARTS] += rate;
    }
    const double all = half[0] + half[1], apart = 2.0 / n * fabs(half[0] - half[1]);
    const double within = fmax(square - 2.0 / n * (half[0] * half[0] + half[1] * half[1]), 0.0) / (n - 2.0);
    f.is_steady = apart <= 4.0 * sqrt(4.0 / n * within) || apart <= 0.04 * all / n;
    if (!f.is_steady) return f;
    f.rate = (sum[last] - sum[first]) / (time[last] - from);
    f.error = sqrt(fmax(square / n - all * all / n / n, 0.0) / (n - 1.0));
    return f;
}

#endif
