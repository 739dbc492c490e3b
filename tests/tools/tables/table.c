/* Checks the functions of a table's header: an image is accepted, and any flipped bit of it is found. */
#include "fog_table_linear.h"
#include "fog_table_squared.h"

#include <stdio.h>
#include <string.h>

static int32_t loaded[FOG_TABLE_WORDS][FOG_TABLE_PARTS];
static unsigned writes;

static void store(void *core, uint32_t address, const int32_t *parts)
{
    memcpy(((int32_t(*)[FOG_TABLE_PARTS])core)[address], parts, sizeof loaded[0]);
    ++writes;
}

static int fails(const char *what)
{
    printf("%s\n", what);
    return 1;
}

int main(int count, char **names)
{
    static uint32_t bus[64];
    fog_table_image image = fog_table_squared;
    fog_table_image read;
    uint8_t bytes[4096];
    size_t size;
    size_t bit;
    FILE *file = fopen(names[count - 1], "rb");
    if (!file) {
        return fails("no file");
    }
    size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    if (fog_table_read(bytes, size, &read) != FOG_TABLE_OK) {
        return fails("the file is refused");
    }
    if (memcmp(read.words, image.words, sizeof read.words) != 0) {
        return fails("the file has other words");
    }
    for (bit = 0; bit < 8 * size; ++bit) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        /* The first 8 bytes, the counts and the size are not part of the image in memory. */
        if (fog_table_read(bytes, size, &read) == FOG_TABLE_OK && bit / 8 >= 24) {
            return fails("a flipped bit of the file is not found");
        }
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    if (fog_table_read(bytes, size - 1, &read) == FOG_TABLE_OK) {
        return fails("a short file is accepted");
    }
    if (fog_table_load(&image, store, loaded) != FOG_TABLE_OK || writes != FOG_TABLE_WORDS) {
        return fails("the image is not loaded");
    }
    if (memcmp(loaded, image.words, sizeof loaded) != 0) {
        return fails("other words are loaded");
    }
    writes = 0;
    for (bit = 0; bit < 8 * sizeof image.words; ++bit) {
        uint8_t *changed = (uint8_t *)image.words + bit / 8;
        *changed ^= (uint8_t)(1u << bit % 8);
        if (fog_table_load(&image, store, loaded) != FOG_TABLE_DAMAGED) {
            return fails("a flipped bit is not found");
        }
        *changed ^= (uint8_t)(1u << bit % 8);
    }
    image.layout ^= 1u;
    if (fog_table_load(&image, store, loaded) != FOG_TABLE_OTHER_CORE || writes != 0) {
        return fails("an image of another core is loaded");
    }
    if (fog_table_load_registers(bus, &fog_table_linear) != FOG_TABLE_OTHER_CORE) {
        return fails("another core is not noticed");
    }
    bus[FOG_REG_CONFIGURATION / 4] = FOG_CONFIGURATION;
    if (fog_table_load_registers(bus, &fog_table_linear) != FOG_TABLE_OK) {
        return fails("the registers are not written");
    }
    if (bus[FOG_REG_TABLE_ADDRESS / 4] != FOG_TABLE_WORDS - 1
        || bus[FOG_REG_TABLE_C0 / 4] != (uint32_t)fog_table_linear.words[FOG_TABLE_WORDS - 1][0]) {
        return fails("the registers have other words");
    }
    return 0;
}
