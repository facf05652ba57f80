/* Text of post chains: any text either makes a chain or one line of error; a chain printed reads back to the same text,
 * and applies to a small frame without harm. */
#include <ambiance/post.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool holds)
{
    if (!holds)
        abort();
}

static void apply(const amb_chain *chain)
{
    amb_frame *frame = NULL;
    if (amb_frame_create(19, 13, &frame, NULL) != AMB_OK)
        return;
    const amb_image *color = amb_frame_layer(frame, "color");
    for (int y = 0; color && y < 13; y++)
        for (int x = 0; x < 19; x++)
            for (int c = 0; c < 3; c++)
                amb_image_row(color, c, y)[x] = (float)((x * 7 + y * 5 + c) % 11) * 0.3f - 0.2f;
    check(amb_chain_apply(chain, frame, 3, 1, NULL) == AMB_OK);
    amb_frame_close(&frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char printed[2][16384];
    if (size > 2000)
        return 0;
    char *text = malloc(size + 1);
    amb_context *context = NULL;
    amb_chain *chain = NULL, *again = NULL;
    amb_error error = {0};
    amb_context_options one = {.threads = 1};
    if (!text || amb_context_create(&one, &context, NULL) != AMB_OK)
        goto done;
    if (size)
        memcpy(text, data, size);
    text[size] = '\0';
    if (amb_chain_create(context, text, &chain, &error) != AMB_OK) {
        check(!chain && error.detail[0] && !strchr(error.detail, '\n'));
        goto done;
    }
    int length = amb_chain_print(chain, printed[0], sizeof printed[0]);
    check(length >= 0 && (size_t)length < sizeof printed[0]);
    check(amb_chain_create(context, printed[0], &again, &error) == AMB_OK);
    amb_chain_print(again, printed[1], sizeof printed[1]);
    check(strcmp(printed[0], printed[1]) == 0);
    apply(again);
done:
    amb_chain_close(&again);
    amb_chain_close(&chain);
    amb_context_close(&context);
    free(text);
    return 0;
}
