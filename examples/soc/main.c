/* A ball, pixel by pixel, once with the highlights of each core: what `glint render` draws with the options that `run` gives.
 *
 * The highlights of every row are computed in three ways, whose clocks are counted. A third series of points has roughness,
 * which a ball without a height map does not.
 */
#include "ball.h"
#include "system.h"
#include "ways.h"

/* ROWS are worked on together, as many as there is memory for. */
enum { ROWS = 12, PIXELS = ROWS * WIDTH };

static pixel pixels[PIXELS];
static point points[PIXELS];
static uint32_t colours[PIXELS];

/* Points so far, and the clocks of the core, the model, and the code by hand. */
typedef struct {
    uint32_t points, spent[3];
} tally;

/* The colours of so many points in three ways; whether all are the same. */
static int compute(const ways *of, unsigned count, tally *tally)
{
    static uint32_t again[2][PIXELS];
    if (count == 0) {
        return 1;
    }
    const uint32_t start = clocks();
    of->core(points, colours, count);
    const uint32_t second = clocks();
    of->model(points, again[0], count);
    const uint32_t third = clocks();
    of->hand(points, again[1], count);
    const uint32_t end = clocks();
    tally->points += count;
    tally->spent[0] += second - start;
    tally->spent[1] += third - second;
    tally->spent[2] += end - third;
    for (unsigned at = 0; at < count; at++) {
        if (colours[at] != again[0][at] || colours[at] != again[1][at]) {
            return 0;
        }
    }
    return 1;
}

/* Whether a smooth surface has a highlight there: the program knows where it is 0, and asks nobody. */
static int shines(const pixel *pixel, const ways *of)
{
    return pixel->lit && (0x100000u - pixel->cos_gamma) * EXPONENT < of->limit;
}

/* The picture of these rows; 0 if the ways do not agree. */
static int draw(const ways *of, enum picture picture, tally *tally)
{
    unsigned count = 0;
    for (unsigned at = 0; at < PIXELS; at++) {
        if (shines(&pixels[at], of)) {
            points[count++] = (point){pixels[at].cos_gamma, 0x100000u, 0};
        }
    }
    if (!compute(of, count, tally)) {
        return 0;
    }
    unsigned shaded = 0;
    for (unsigned at = 0; at < PIXELS; at++) {
        const uint32_t colour = shines(&pixels[at], of) ? colours[shaded++] : 0;
        for (unsigned channel = 0; channel < 3; channel++) {
            const double sum = pixels[at].base[channel] + (double)(colour >> (8 * channel) & 0xffu);
            show(picture, (uint32_t)((sum > 255.0 ? 255.0 : sum) + 0.5));
        }
    }
    return 1;
}

/* The pixels in the light, with a roughness that looks random: cosines of dgamma down to 7/8, 29 degrees. */
static int roughen(tally *tally)
{
    static uint32_t state = 1;
    unsigned count = 0;
    for (unsigned at = 0; at < PIXELS; at++) {
        if (pixels[at].lit) {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            points[count++] = (point){pixels[at].cos_gamma, 0x100000u - (state >> 8 & 0x1ffffu), state & 1u};
        }
    }
    return compute(&grain_ways, count, tally);
}

int main(void)
{
    if (!shade_begin(SPECULAR) || !grain_begin(SPECULAR)) {
        return 1;
    }
    const vector light = unit((vector){-0.6, 0.8, 0.9});
    tally shade = {0}, smooth = {0}, rough = {0};
    for (unsigned row = 0; row < HEIGHT; row += ROWS) {
        for (unsigned at = 0; at < PIXELS; at++) {
            pixels[at] = geometry(at % WIDTH, row + at / WIDTH, light);
        }
        if (!draw(&shade_ways, SHADE_PICTURE, &shade) ||
            !draw(&smooth_ways, GRAIN_PICTURE, &smooth) || !roughen(&rough)) {
            return 2;
        }
    }
    const tally *const all[] = {&shade, &smooth, &rough};
    for (unsigned at = 0; at < 3; at++) {
        number(all[at]->points);
        for (unsigned way = 0; way < 3; way++) {
            number(all[at]->spent[way]);
        }
    }
    return 0;
}
