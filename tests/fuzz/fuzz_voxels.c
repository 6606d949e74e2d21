/* The readers of voxel images: any bytes give an image, or one line. */
#include "fuzz.h"

#include "examples/voxel_file.h"

static void check(int status, voxel_image *m, const char *message) {
    if (status != 0) {
        FUZZ_ASSERT(message[0] && !strchr(message, '\n') && !m->value);
        return;
    }
    FUZZ_ASSERT(m->value && m->n[0] >= 1 && m->n[1] >= 1 && m->n[2] >= 1);
    double sum = 0.0;
    for (size_t i = 0; i < voxel_count(m); i++) sum += (double)m->value[i];
    FUZZ_ASSERT(sum == sum || sum != sum); /* each value can be read */
    free(m->value);
}

/* Two pages of 3 x 2 values of 8 bits, little end first. */
static size_t make_tif(uint8_t *to) {
    static const unsigned tags[9][3] = {{256, 3, 3}, {257, 3, 2}, {258, 3, 8}, {259, 3, 1}, {262, 3, 1},
                                        {273, 4, 0}, {277, 3, 1}, {278, 3, 2}, {279, 4, 6}};
    size_t at = 8;
    memcpy(to, "II*\0\10\0\0\0", 8);
    for (unsigned page = 0; page < 2; page++) {
        const unsigned pixels = (unsigned)at + 2 + 9 * 12 + 4, next = page == 0 ? pixels + 6 : 0;
        to[at++] = 9, to[at++] = 0;
        for (int k = 0; k < 9; k++) {
            const unsigned value = tags[k][0] == 273 ? pixels : tags[k][2];
            const unsigned words[3] = {tags[k][0] | tags[k][1] << 16, 1, value};
            for (int w = 0; w < 3; w++)
                for (int b = 0; b < 4; b++) to[at++] = (uint8_t)(words[w] >> (8 * b));
        }
        for (int b = 0; b < 4; b++) to[at++] = (uint8_t)(next >> (8 * b));
        for (int k = 0; k < 6; k++) to[at++] = (uint8_t)(10 * k);
    }
    return at;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static const double n[3] = {2.0, 3.0, 2.0};
    char message[300] = "", *text = (char *)malloc(size + 1);
    uint8_t tif[300];
    voxel_image m;
    if (!text) return 0;
    memcpy(text, bytes, size), text[size] = 0;
    memset(&m, 0, sizeof m);
    check(voxel_vti(text, size, size % 2 ? "g" : NULL, &m, message, sizeof message), &m, message);
    memset(&m, 0, sizeof m);
    check(voxel_tif(bytes, size, &m, message, sizeof message), &m, message);
    memset(&m, 0, sizeof m);
    check(voxel_raw(bytes, size, n, (int)(size % 3), size % 5, &m, message, sizeof message), &m, message);
    const size_t whole = make_tif(tif); /* the input tells which bytes of a good file become which */
    for (size_t k = 0; k + 1 < size && k < 16; k += 2) tif[bytes[k] % whole] = bytes[k + 1];
    memset(&m, 0, sizeof m);
    check(voxel_tif(tif, size % 4 ? whole : whole - bytes[0] % whole, &m, message, sizeof message), &m, message);
    free(text);
    return 0;
}

#define HEAD                                                                                                           \
    "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt32\"><ImageData WholeExtent=\"0 2 0 1 " \
    "0 2\" Spacing=\"1 1 1\">"
static const char *const samples[] = {
    HEAD "<CellData><DataArray type=\"Int32\" Name=\"g\" format=\"ascii\"> 1 2 3 4 "
         "</DataArray></CellData></ImageData></VTKFile>",
    HEAD "<CellData><DataArray type=\"UInt8\" Name=\"g\" "
         "format=\"binary\">BAAAAAECAwQ=</DataArray></CellData></ImageData></VTKFile>",
    HEAD "<CellData><DataArray type=\"UInt8\" Name=\"g\" format=\"appended\" "
         "offset=\"0\"/></CellData></ImageData><AppendedData "
         "encoding=\"base64\">_BAAAAAECAwQ=</AppendedData></VTKFile>",
    HEAD
    "<PointData><DataArray type=\"Float32\" Name=\"g\" format=\"appended\" "
    "offset=\"2\"/></PointData></ImageData><AppendedData "
    "encoding=\"raw\">_0123456789012345678901234567890123456789012345678901234567890123456789012345678901234567890123</"
    "AppendedData>",
    "II*",
    "\1\2\3\4\5\6\7\10\11\12\13\14",
    "x",
};

FUZZ_MAIN(samples, 7, 20000)
