// threshold_levels_axil_tb: self-checking bench of threshold_levels_axil
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s threshold_levels_axil_tb -o sim threshold_levels*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top threshold_levels_axil_tb threshold_levels*.v
//   $ obj_dir/Vthreshold_levels_axil_tb
// The bench writes the operands of points of the core's bench, starts each computation in one of
// the possible ways in turn, and reads the results. Inputs change on the falling edge of the clock.
// Outputs are read just before the rising edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module threshold_levels_axil_tb #(
    parameter SENT_FILE     = "threshold_levels_sent.mem",
    parameter RECEIVED_FILE = "threshold_levels_received.mem"
);
    localparam POINTS   = 2152;
    localparam EVERY    = 9;  // the bench computes one point in so many
    localparam PARTS    = 5;  // the number of operand registers
    localparam RESULTS  = 1;  // the number of result registers
    localparam WORDS    = 14;  // the number of registers
    localparam LIMIT    = 10938;  // the most clocks until an answer
    localparam REPORTED = 20;  // the number of differences to print
    localparam [31:0] STATUS = 32'h10, CONTROL = 32'h14, ENABLE = 32'h18, PENDING = 32'h1c;

    reg [63:0] sent [0:POINTS-1];
    reg [23:0] received [0:POINTS-1];
    reg [63:0] point;
    reg [23:0] result;

    // The initial values are set here: threshold_levels_tb.v says why.
    reg clk = 1'b0;
    reg reset = 1'b1;
    reg irq_enabled = 1'b0;
    reg answered;
    reg failed;
    reg [31:0] got;
    reg [31:0] random = 32'd1;
    integer number = 0;
    integer part = 0;
    integer waited = 0;
    integer errors = 0;
    integer accesses = 0;
    wire irq;
    always #5 clk = ~clk;

    // The access that `access` asks for.
    reg asked = 1'b0;
    reg asked_write;
    reg [31:0] asked_address;
    reg [31:0] asked_data;
    reg [3:0] asked_bytes;

    task check(input right, input string what);
        if (right !== 1'b1) begin
            if (errors < REPORTED) $display("point %0d, access %0d: %0s", number, accesses, what);
            errors = errors + 1;
        end
    endtask

    task verdict;
        begin
            if (errors != 0) begin
                $display("FAIL threshold_levels_axil: %0d differences", errors);
                $fatal;
            end
            $display("PASS threshold_levels_axil: %0d accesses, no difference", accesses);
            $finish;
        end
    endtask

    // Waits until just before the next rising edge of the clock, when outputs can be read.
    task wait_a_clock;
        begin
            waited = waited + 1;
            if (waited > LIMIT) begin
                check(1'b0, "no answer");
                verdict;
            end
            #4;
        end
    endtask

    // Does one access to a register, and waits until it is done. The process below calls
    // `do_access`, so that a compiler that copies a task to each of its calls copies it once.
    task access(input [31:0] address, input writes, input [31:0] data, input [3:0] bytes);
        begin
            asked_address = address;
            asked_write = writes;
            asked_data = data;
            asked_bytes = bytes;
            asked = 1'b1;
            wait (!asked);
        end
    endtask

    reg [31:0] awaddr = 32'd0;
    reg awvalid = 1'b0;
    wire awready;
    reg [31:0] wdata = 32'd0;
    reg [3:0] wstrb = 4'd0;
    reg wvalid = 1'b0;
    wire wready;
    wire [1:0] bresp;
    wire bvalid;
    reg bready = 1'b0;
    reg [31:0] araddr = 32'd0;
    reg arvalid = 1'b0;
    wire arready;
    wire [31:0] rdata;
    wire [1:0] rresp;
    wire rvalid;
    reg rready = 1'b0;
    reg address_taken;
    reg data_taken;
    threshold_levels_axil dut (
        .aclk(clk),
        .aresetn(~reset),
        .s_axil_awaddr(awaddr[5:0]),
        .s_axil_awprot(random[14:12]),
        .s_axil_awvalid(awvalid),
        .s_axil_awready(awready),
        .s_axil_wdata(wdata),
        .s_axil_wstrb(wstrb),
        .s_axil_wvalid(wvalid),
        .s_axil_wready(wready),
        .s_axil_bresp(bresp),
        .s_axil_bvalid(bvalid),
        .s_axil_bready(bready),
        .s_axil_araddr(araddr[5:0]),
        .s_axil_arprot(random[17:15]),
        .s_axil_arvalid(arvalid),
        .s_axil_arready(arready),
        .s_axil_rdata(rdata),
        .s_axil_rresp(rresp),
        .s_axil_rvalid(rvalid),
        .s_axil_rready(rready),
        .irq(irq)
    );

    // Does the write or the read that `access` asks for. Address, data and the ready for the
    // response come in random order.
    task do_access;
        begin
            address_taken = 1'b0;
            data_taken = ~asked_write;
            while (!answered) begin
                awvalid = asked_write && !address_taken && waited >= {30'd0, random[1:0]};
                wvalid = !data_taken && waited >= {30'd0, random[3:2]};
                arvalid = !asked_write && !address_taken && waited >= {30'd0, random[1:0]};
                bready = asked_write && waited >= {29'd0, random[6:4]};
                rready = !asked_write && waited >= {29'd0, random[6:4]};
                awaddr = awvalid ? asked_address | {30'd0, random[9:8]} : ~asked_address;
                araddr = arvalid ? asked_address | {30'd0, random[9:8]} : ~asked_address;
                wdata = wvalid ? asked_data : ~asked_data;
                wstrb = wvalid ? asked_bytes : ~asked_bytes;
                wait_a_clock;
                check((bvalid & rvalid) === 1'b0, "two answers");
                if (bvalid || rvalid) check(address_taken && data_taken, "an answer too early");
                if (awvalid && awready || arvalid && arready) address_taken = 1'b1;
                if (wvalid && wready) data_taken = 1'b1;
                answered = bvalid && bready || rvalid && rready;
                failed = asked_write ? bresp[1] : rresp[1];
                got = rdata;
                if (answered) check((asked_write ? bresp[0] : rresp[0]) === 1'b0, "the response");
                @(negedge clk);
            end
            {awvalid, wvalid, arvalid, bready, rready} = 5'd0;
        end
    endtask

    // Does the accesses that `access` asks for.
    initial forever begin
        wait (asked);
        accesses = accesses + 1;
        random = {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        waited = 0;
        answered = 1'b0;
        do_access;
        asked = 1'b0;
    end

    function [31:0] part_at(input integer number);
        case (number)
            0: part_at = 32'h20;
            1: part_at = 32'h24;
            2: part_at = 32'h28;
            3: part_at = 32'h2c;
            4: part_at = 32'h30;
            default: part_at = 32'd0;
        endcase
    endfunction
    // part_word is the word that the bench writes, with arbitrary bits above the operand. part_mask
    // has the bits that read back.
    function [31:0] part_word(input integer number);
        case (number)
            0: part_word = {{8{point[0]}}, point[23:0]};
            1: part_word = {{16{point[0]}}, point[39:24]};
            2: part_word = {{24{point[0]}}, point[47:40]};
            3: part_word = {{24{point[0]}}, point[55:48]};
            4: part_word = {{24{point[0]}}, point[63:56]};
            default: part_word = 32'd0;
        endcase
    endfunction
    function [31:0] part_mask(input integer number);
        case (number)
            0: part_mask = 32'h001fffff;
            1: part_mask = 32'h000003ff;
            2: part_mask = 32'h000000ff;
            3: part_mask = 32'h000000ff;
            4: part_mask = 32'h000000ff;
            default: part_mask = 32'd0;
        endcase
    endfunction
    function [31:0] result_at(input integer number);
        case (number)
            0: result_at = 32'h34;
            default: result_at = 32'd0;
        endcase
    endfunction
    function [31:0] result_word(input integer number);
        case (number)
            0: result_word = {{8{1'b0}}, result[23:0]};
            default: result_word = 32'd0;
        endcase
    endfunction

    task write(input [31:0] address, input [31:0] data, input [3:0] bytes);
        begin
            access(address, 1'b1, data, bytes);
            check(!failed, "a write fails");
        end
    endtask

    task expect_word(input [31:0] address, input [31:0] word);
        begin
            access(address, 1'b0, 32'd0, 4'hf);
            check(!failed, "a read fails");
            if (got !== word && errors < REPORTED)
                $display("at %h: %h, not %h", address, got, word);
            check(got === word, "what is read");
        end
    endtask

    // A write must fail. A read must fail too if `reads` is 1, and must not if it is 0.
    task expect_error(input [31:0] address, input reads);
        begin
            access(address, 1'b1, 32'hffff_ffff, 4'hf);
            check(failed, "a write does not fail");
            access(address, 1'b0, 32'd0, 4'hf);
            check(failed == reads, "whether a read fails");
        end
    endtask

    task write_operands;
        for (part = 0; part < PARTS; part = part + 1) write(part_at(part), part_word(part), 4'hf);
    endtask

    // Writes each byte of a word alone, with wrong data in the bytes that are not enabled.
    task write_bytes;
        for (part = 0; part < PARTS; part = part + 1) begin
            write(part_at(part), part_word(part) ^ 32'hffff_ff00, 4'b0001);
            write(part_at(part), part_word(part) ^ 32'hff00_ffff, 4'b0100);
            write(part_at(part), part_word(part) ^ 32'h00ff_ffff, 4'b1000);
            write(part_at(part), part_word(part) ^ 32'hffff_00ff, 4'b0010);
        end
    endtask

    task expect_operands;
        for (part = 0; part < PARTS; part = part + 1) begin
            expect_word(part_at(part), part_word(part) & part_mask(part));
        end
    endtask

    task expect_results;
        for (part = 0; part < RESULTS; part = part + 1) begin
            expect_word(result_at(part), result_word(part));
        end
    endtask

    // Reads all registers and expects their values after a reset.
    task expect_reset;
        begin
            point = 0;
            result = 0;
            expect_word(32'h00, 32'h474c4e54);
            expect_word(32'h04, 32'h00000100);
            expect_word(32'h08, 32'h038823a5);
            expect_word(32'h0c, 32'h00000305);
            expect_word(32'h10, 32'h00000000);
            expect_word(32'h14, 32'h00000c00);
            expect_word(32'h18, 32'h00000000);
            expect_word(32'h1c, 32'h00000000);
            expect_operands;
            expect_results;
            check(!irq, "an interrupt");
        end
    endtask

    // Makes the register of the chosen part the start register, and writes it. Before that, it
    // checks that writes in which the byte of the start bit is not enabled start nothing.
    task start_by_write(input integer chosen);
        begin
            write(CONTROL, 32'd2 | part_at(chosen) << 6, 4'b1111);
            expect_word(CONTROL, 32'd2 | part_at(chosen) << 6);
            write(part_at(chosen), ~part_word(chosen), 4'b0000);
            write(CONTROL, 32'd1, 4'b0000);
            write(CONTROL, 32'd1 | part_at(chosen) << 6, 4'b0010);
            expect_word(STATUS, 32'd2);
            write(part_at(chosen), part_word(chosen), number / EVERY % 8 > 3 ? 4'b0001 : 4'b1111);
        end
    endtask

    initial begin
        $readmemh(SENT_FILE, sent);
        $readmemh(RECEIVED_FILE, received);
        repeat (3) @(negedge clk);
        reset = 1'b0;
        expect_reset;
        expect_error(32'h00, 1'b0);
        expect_error(32'h04, 1'b0);
        expect_error(32'h08, 1'b0);
        expect_error(32'h0c, 1'b0);
        expect_error(32'h10, 1'b0);
        expect_error(32'h34, 1'b0);
        for (part = WORDS; part < 16; part = part + 1) expect_error(part << 2, 1'b1);
        expect_reset;
        while (number < POINTS) begin
            point = sent[number];
            result = received[number];
            irq_enabled = number / EVERY % 8 > 3;
            write(ENABLE, {31'd0, irq_enabled}, 4'b0001);
            write(ENABLE, {31'd0, ~irq_enabled}, 4'b1110);
            expect_word(ENABLE, {31'd0, irq_enabled});
            if (number / EVERY % 4 == 1) write_bytes;
            else write_operands;
            if (number / EVERY % 2 == 0) expect_operands;
            if (number / EVERY % 4 == 3) begin
                start_by_write(number / EVERY / 4 % PARTS);
            end else begin
                write(CONTROL, 32'd1, 4'b0001);
            end
            if (number / EVERY % 4 == 2) begin
                // The operands of another point must not change this computation.
                point = ~point;
                write_operands;
                expect_operands;
            end
            expect_results;
            expect_word(STATUS, 32'd2);
            check(irq === irq_enabled, "the interrupt");
            write(PENDING, 32'd0, 4'b1111);
            write(PENDING, 32'd1, 4'b1110);
            expect_word(PENDING, 32'd1);
            write(PENDING, 32'd1, 4'b0001);
            expect_word(PENDING, 32'd0);
            check(!irq, "an interrupt that was cleared");
            write(CONTROL, 32'd0, 4'b0001);
            expect_results;
            number = number + EVERY;
        end
        // A reset ends the computation.
        write(ENABLE, 32'd1, 4'b1111);
        write(CONTROL, 32'd1, 4'b0001);
        reset = 1'b1;
        @(negedge clk);
        @(negedge clk);
        reset = 1'b0;
        expect_reset;
        verdict;
    end
endmodule

`default_nettype wire
