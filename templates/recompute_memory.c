/* Compares a memory file with the table of the model. */
static void check_memory(const char *directory, const char *name, const void *table, size_t bytes, size_t count)
{
    char path[4096], line[4096];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        perror(path);
        exit(2);
    }
    size_t at = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        char *comment = strstr(line, "//");
        if (comment != NULL) {
            *comment = '\0';
        }
        for (char *token = strtok(line, " \t\r\n"); token != NULL; token = strtok(NULL, " \t\r\n"), ++at) {
            char *end;
            const uint64_t word = strtoull(token, &end, 16);
            if (!isxdigit((unsigned char)token[0]) || *end != '\0' || strpbrk(token, "xX") != NULL) {
                printf("%s: word %zu is not a hexadecimal number: %s\n", path, at, token);
                exit(1);
            }
            const uint64_t own = at >= count  ? ~word
                                 : bytes == 1 ? ((const uint8_t *)table)[at]
                                 : bytes == 2 ? ((const uint16_t *)table)[at]
                                 : bytes == 4 ? ((const uint32_t *)table)[at]
                                              : ((const uint64_t *)table)[at];
            if (word != own) {
                printf("%s: word %zu differs from the model\n", path, at);
                exit(1);
            }
        }
    }
    fclose(file);
    if (at != count) {
        printf("%s: %zu words, but the model has %zu\n", path, at, count);
        exit(1);
    }
}

/* Compares every memory file in a directory with the model's table. */
static void check_memories(const char *directory)
{
<%- for (file, table, count) in memories %>
    check_memory(directory, "${ file }$", ${ table }$, sizeof *${ table }$, ${ count }$);
<%- endfor %>
}
