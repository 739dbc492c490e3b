<%- if is_cfu %>
    reg cmd_valid = 1'b0;
    wire cmd_ready;
    reg [9:0] function_id = 10'd0;
    reg [31:0] inputs_0 = 32'd0;
    reg [31:0] inputs_1 = 32'd0;
    wire rsp_valid;
    reg rsp_ready = 1'b0;
    wire [31:0] outputs_0;
    ${ top }$ dut (
        .clk(clk),
        .reset(reset),
<%- for port in table_ports %>
        ${ port }$
<%- endfor %>
        .cmd_valid(cmd_valid),
        .cmd_ready(cmd_ready),
        .cmd_payload_function_id(function_id),
        .cmd_payload_inputs_0(inputs_0),
        .cmd_payload_inputs_1(inputs_1),
        .rsp_valid(rsp_valid),
        .rsp_ready(rsp_ready),
        .rsp_payload_outputs_0(outputs_0)
    );

    // Sends a command, changes its inputs afterwards, and takes the answer after some clocks.
    task execute;
        begin
            cmd_valid = 1'b1;
            function_id = asked;
            inputs_0 = word_0;
            inputs_1 = word_1;
            while (!answered) begin
                wait_a_clock;
                answered = cmd_ready;
                check(!rsp_valid, "an answer without a command");
                @(negedge clk);
            end
            cmd_valid = random[5];
            function_id = ~asked;
            inputs_0 = ~word_0;
            inputs_1 = ~word_1;
            answered = 1'b0;
            while (!answered) begin
                wait_a_clock;
                answered = rsp_valid;
                got = outputs_0;
                check(!cmd_ready, "a command is taken before the answer to the one before it");
                @(negedge clk);
            end
            check(got === want, "the answer");
            cmd_valid = 1'b0;
            repeat ({30'd0, random[1:0]}) begin
                wait_a_clock;
                check(rsp_valid && outputs_0 === want, "an answer that waits");
                @(negedge clk);
            end
            rsp_ready = 1'b1;
            @(negedge clk);
            rsp_ready = 1'b0;
        end
    endtask
<%- else %>
    reg pcpi_valid = 1'b0;
    reg [31:0] pcpi_insn = 32'd0;
    reg [31:0] pcpi_rs1 = 32'd0;
    reg [31:0] pcpi_rs2 = 32'd0;
    wire pcpi_wr;
    wire [31:0] pcpi_rd;
    wire pcpi_wait;
    wire pcpi_ready;
    ${ top }$ dut (
        .clk(clk),
        .resetn(~reset),
<%- for port in table_ports %>
        ${ port }$
<%- endfor %>
        .pcpi_valid(pcpi_valid),
        .pcpi_insn(pcpi_insn),
        .pcpi_rs1(pcpi_rs1),
        .pcpi_rs2(pcpi_rs2),
        .pcpi_wr(pcpi_wr),
        .pcpi_rd(pcpi_rd),
        .pcpi_wait(pcpi_wait),
        .pcpi_ready(pcpi_ready)
    );

    // Offers an instruction until it is answered, first in some turns with another major opcode.
    // The module does not answer an instruction that it does not know.
    task execute;
        begin
            pcpi_valid = 1'b1;
            pcpi_rs1 = word_0;
            pcpi_rs2 = word_1;
            pcpi_insn = {asked[9:3], random[17:8], asked[2:0], random[22:18], 7'b0101011};
            repeat (random[0] ? 2 : known ? 0 : 3) begin
                if (!random[0]) pcpi_insn[6:0] = 7'b0001011;
                wait_a_clock;
                check(!pcpi_wait && !pcpi_ready, "an answer to another instruction");
                @(negedge clk);
            end
            pcpi_insn[6:0] = 7'b0001011;
            while (known && !answered) begin
                wait_a_clock;
                answered = pcpi_ready;
                got = pcpi_rd;
                check(pcpi_wait && pcpi_wr === pcpi_ready, "the handshake");
                @(negedge clk);
            end
            check(!known || got === want, "the answer");
            pcpi_valid = 1'b0;
            repeat ({30'd0, random[2:1]}) begin
                wait_a_clock;
                check(!pcpi_ready && !pcpi_wait, "an answer without an instruction");
                @(negedge clk);
            end
        end
    endtask
<%- endif %>
