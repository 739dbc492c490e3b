/* A ball, pixel by pixel, with the highlights of `shade` and of `grain`: what `glint render` draws with the options that `run` gives.
 * Then a cushion, whose colours `lit` computes from normals of any length.
 *
 * The pixels are computed in all ways that a device has, whose clocks are counted. A further series of points has roughness, which a
 * ball without a height map does not. At the end, the processor computes three functions by instructions.
 */
#include "ball.h"
#include "cushion.h"
#include "functions.h"
#include "system.h"
#include "ways.h"

/* ROWS are worked on together, as many as there is memory for. */
enum { ROWS = 4, PIXELS = ROWS * WIDTH };

static pixel pixels[PIXELS];
static span spans[PIXELS / 2];
static unsigned span_count;
static uint32_t operands[2 * PIXELS];
static uint32_t frames[WAYS][PIXELS];

/* Pixels so far, and the clocks of each way. */
typedef struct {
    uint32_t pixels, spent[WAYS];
} tally;

/* The runs of pixels in the light. */
static void find_spans(void)
{
    span_count = 0;
    unsigned run = 0;
    for (unsigned at = 0; at < PIXELS; at++) {
        run = at % WIDTH == 0 ? 0 : run;
        if (pixels[at].lit) {
            if (run == 0) {
                spans[span_count++].first = at;
            }
            spans[span_count - 1].count = ++run;
        } else {
            run = 0;
        }
    }
}

/* Whether no colour of two pixels differs by more than `most`. */
static int is_near(uint32_t pixel, uint32_t other, unsigned most)
{
    for (unsigned channel = 0; channel < 3; channel++) {
        const uint32_t a = pixel >> (8 * channel) & 0xffu, b = other >> (8 * channel) & 0xffu;
        if ((a > b ? a - b : b - a) > most) {
            return 0;
        }
    }
    return 1;
}

/* Whether the pixels of all spans in two frame buffers differ by at most `most` a colour. */
static int near(const uint32_t *frame, const uint32_t *other, unsigned most)
{
    for (const span *span = spans; span < spans + span_count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            if (!is_near(frame[at], other[at], most)) {
                return 0;
            }
        }
    }
    return 1;
}

/* Whether the pixels of all spans are the same in two frame buffers. */
static int same(const uint32_t *frame, const uint32_t *other) { return near(frame, other, 0); }

/* The pixels of all spans in every way; whether all are the same, C by hand up to its tolerance. */
static int compute(const device *device, tally *tally)
{
    for (unsigned way = 0; way < WAYS; way++) {
        if (device->ways[way] == 0) {
            continue;
        }
        const uint32_t start = clocks();
        device->ways[way](spans, span_count, operands, frames[way]);
        tally->spent[way] += clocks() - start;
    }
    for (const span *span = spans; span < spans + span_count; span++) {
        tally->pixels += span->count;
    }
    for (unsigned way = 1; way < WAYS; way++) {
        const unsigned most = way == BY_HAND ? device->tolerance : 0;
        if (device->ways[way] != 0 && !near(frames[0], frames[way], most)) {
            return 0;
        }
    }
    return 1;
}

/* The picture of these rows; 0 if the ways do not agree. */
static int draw(const device *device, enum picture picture, tally *tally)
{
    for (unsigned at = 0; at < PIXELS; at++) {
        operands[device->words * at] = pixels[at].cos_gamma;
        if (device->words == 2) {
            operands[2 * at + 1] = ONE;
        }
    }
    if (!compute(device, tally)) {
        return 0;
    }
    for (unsigned at = 0; at < PIXELS; at++) {
        const uint32_t colour = pixels[at].lit ? frames[0][at] : 0;
        for (unsigned channel = 0; channel < 3; channel++) {
            const double sum = pixels[at].base[channel] + (double)(colour >> (8 * channel) & 0xffu);
            show(picture, (uint32_t)((sum > 255.0 ? 255.0 : sum) + 0.5));
        }
    }
    return 1;
}

/* The same pixels with a roughness that looks random: cosines of dgamma down to 7/8, 29 degrees. */
static int roughen(tally *tally)
{
    static uint32_t state = 1;
    for (unsigned at = 0; at < PIXELS; at++) {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        operands[2 * at] = pixels[at].cos_gamma;
        operands[2 * at + 1] = (ONE - (state >> 8 & 0x1ffffu)) | (state & 1u ? NEGATIVE : 0u);
    }
    return compute(&grain, tally);
}

/* The spans of both devices at once, which share the RAM with the processor; whether all is as it was. */
static int together(const uint32_t *cosines, const uint32_t *shaded)
{
    for (const span *span = spans; span < spans + span_count; span++) {
        begin_span(SHADE_SPANS, shade.words, span, cosines, frames[1]);
        begin_span(GRAIN_SPANS, grain.words, span, operands, frames[2]);
    }
    end_spans(SHADE_SPANS);
    end_spans(GRAIN_SPANS);
    return same(frames[1], shaded) && same(frames[2], frames[0]);
}

/* The rows of the cushion from `row` on; 0 if the ways do not agree. */
static int draw_cushion(unsigned row, tally *tally)
{
    static const uint8_t background[3] = {13, 15, 20};
    for (unsigned at = 0; at < PIXELS; at++) {
        pixels[at].lit = (uint32_t)cushion(at % WIDTH, row + at / WIDTH, &operands[at]);
    }
    find_spans();
    if (!compute(&lit, tally)) {
        return 0;
    }
    for (unsigned at = 0; at < PIXELS; at++) {
        for (unsigned channel = 0; channel < 3; channel++) {
            show(LIT_PICTURE, pixels[at].lit ? frames[0][at] >> (8 * channel) & 0xffu : background[channel]);
        }
    }
    return 1;
}

int main(void)
{
    static uint32_t cosines[PIXELS], shaded[PIXELS];
    if (!shade_begin(SPECULAR) || !grain_begin(SPECULAR)) {
        return 1;
    }
    const vector light = unit((vector){-0.6, 0.8, 0.9});
    tally of_shade = {0}, smooth = {0}, rough = {0}, of_lit = {0};
    for (unsigned row = 0; row < HEIGHT; row += ROWS) {
        for (unsigned at = 0; at < PIXELS; at++) {
            pixels[at] = geometry(at % WIDTH, row + at / WIDTH, light);
        }
        find_spans();
        if (!draw(&shade, SHADE_PICTURE, &of_shade)) {
            return 2;
        }
        memcpy(cosines, operands, sizeof cosines);
        memcpy(shaded, frames[0], sizeof shaded);
        if (!draw(&grain, GRAIN_PICTURE, &smooth) || !roughen(&rough) || !together(cosines, shaded)) {
            return 2;
        }
    }
    lit_begin(200, 140, 60);
    for (unsigned row = 0; row < HEIGHT; row += ROWS) {
        if (!draw_cushion(row, &of_lit)) {
            return 2;
        }
    }
    const tally *const all[] = {&of_shade, &smooth, &rough, &of_lit};
    for (unsigned at = 0; at < sizeof all / sizeof all[0]; at++) {
        number(all[at]->pixels);
        for (unsigned way = 0; way < WAYS; way++) {
            number(all[at]->spent[way]);
        }
    }
    uint32_t spent[FUNCTIONS][FUNCTION_WAYS];
    if (!compute_functions(spent)) {
        return 3;
    }
    number(VALUES);
    for (unsigned function = 0; function < FUNCTIONS; function++) {
        for (unsigned way = 0; way < FUNCTION_WAYS; way++) {
            number(spent[function][way]);
        }
    }
    return 0;
}
