/* The CSV reader: any bytes give a table whose cells agree with its numbers, or one line. */
#include "fuzz.h"

#include "csv.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    csv_data data;
    char message[120] = "";
    int status = csv_parse((const char *)bytes, (long)size, "input", &data, message, (int)sizeof message);
    if (status != 0) {
        FUZZ_ASSERT(status == -1 && message[0] && !data.memory && !data.values && data.rows == 0);
        FUZZ_ASSERT(!strchr(message, '\n'));
        return 0;
    }
    FUZZ_ASSERT(data.columns > 0 && data.rows >= 0 && !message[0]);
    for (int k = 0; k < data.columns; k++) FUZZ_ASSERT(csv_column(&data, data.names[k]) <= k);
    for (int i = 0; i < data.rows * data.columns; i++) {
        double v = data.values[i];
        FUZZ_ASSERT(v != v || (*data.cells[i] && strtod(data.cells[i], NULL) == v));
    }
    csv_free(&data);
    return 0;
}

static const char *const samples[] = {
    "a,b,c\n1,2,3\n4,5,6\n",
    "# comment\n\nx , y # note\r\n1e-300,-2\r\n,\n",
    "name,\"a, b\"\n\"x, y\",2\nz,3\n",
    "t\n1\n2\nnan\ninf\n",
    "a,b\n1,2,3\n",
    "",
};

FUZZ_MAIN(samples, 6, 200000)
