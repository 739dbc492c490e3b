// cosine_power_registers_formal: formal properties of cosine_power_registers
//
// For formal tools only. All inputs are arbitrary. A stub with the handshake of the core replaces
// the core: busy is high from the clock after start to done, and the results are arbitrary. To
// prove the properties, run in a directory with the files of both folders:
//   $ yosys -q cosine_power_registers_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 cosine_power_registers_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 cosine_power_registers_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none
module cosine_power (
    input wire clk,
    input wire rst_n,
    input wire start,
    input wire [20:0] cos_gamma,
    input wire cos_gamma_write,
    input wire [9:0] exponent,
    input wire exponent_write,
    input wire [7:0] red,
    input wire red_write,
    input wire [7:0] green,
    input wire green_write,
    input wire [7:0] blue,
    input wire blue_write,
    output wire valid,
    output wire busy,
    output wire done,
    output wire [7:0] red_out,
    output wire [7:0] green_out,
    output wire [7:0] blue_out
);
    (* anyseq *) reg ends;
    (* anyseq *) reg [7:0] any_red_out;
    assign red_out = any_red_out;
    (* anyseq *) reg [7:0] any_green_out;
    assign green_out = any_green_out;
    (* anyseq *) reg [7:0] any_blue_out;
    assign blue_out = any_blue_out;
    reg run;
    assign busy = run;
    assign valid = done;
    assign done = run & ends;
    always @(posedge clk) run <= rst_n & (run ? ~done : start);

    // A computation starts only after the computation before it has ended, and loads all operands.
    always @* if (!$initstate && start) begin
        assert (!run);
        assert (cos_gamma_write);
        assert (exponent_write);
        assert (red_write);
        assert (green_write);
        assert (blue_write);
    end
endmodule

module cosine_power_registers_formal (
    input wire clk,
    input wire rst_n,
    input wire write,
    input wire [5:2] write_at,
    input wire [31:0] write_data,
    input wire [3:0] write_bytes,
    input wire read,
    input wire [5:2] read_at
);
    wire write_answer;
    wire write_error;
    wire read_answer;
    wire read_error;
    wire [31:0] read_data;
    wire irq;

    cosine_power_registers dut (
        .clk(clk),
        .rst_n(rst_n),
        .write(write),
        .write_at(write_at),
        .write_data(write_data),
        .write_bytes(write_bytes),
        .write_answer(write_answer),
        .write_error(write_error),
        .read(read),
        .read_at(read_at),
        .read_answer(read_answer),
        .read_error(read_error),
        .read_data(read_data),
        .irq(irq)
    );

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire \dut.start ;
    (* hierconn *) wire \dut.start_on_write ;
    (* hierconn *) wire [3:0] \dut.start_word ;
    (* hierconn *) wire \dut.interrupt_enable ;
    (* hierconn *) wire \dut.interrupt_pending ;
    (* hierconn *) wire \dut.finished ;
    (* hierconn *) wire \dut.core.rst_n ;
    (* hierconn *) wire \dut.core.run ;
    (* hierconn *) wire \dut.core.ends ;
    (* hierconn *) wire [20:0] \dut.operand_cos_gamma ;
    (* hierconn *) wire [20:0] \dut.core.cos_gamma ;
    (* hierconn *) wire [9:0] \dut.operand_exponent ;
    (* hierconn *) wire [9:0] \dut.core.exponent ;
    (* hierconn *) wire [7:0] \dut.operand_red ;
    (* hierconn *) wire [7:0] \dut.core.red ;
    (* hierconn *) wire [7:0] \dut.operand_green ;
    (* hierconn *) wire [7:0] \dut.core.green ;
    (* hierconn *) wire [7:0] \dut.operand_blue ;
    (* hierconn *) wire [7:0] \dut.core.blue ;
    (* hierconn *) wire [7:0] \dut.core.red_out ;
    (* hierconn *) wire [7:0] \dut.core.green_out ;
    (* hierconn *) wire [7:0] \dut.core.blue_out ;

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    localparam WORDS = 14;
    wire [31:0] write_word = write_at;
    wire [31:0] read_word = read_at;
    wire write_mapped =
            write_word >= 5 && write_word <= 12;
    wire is_result =
            read_word >= 13 && read_word <= 13;
    wire start_waits = dut.start || dut.core.run;
    wire result_waits = start_waits;
    wire ended = dut.core.run && dut.core.ends;
    wire asks_start = write_mapped
            && (dut.start_on_write && write_word == dut.start_word && write_bytes != 0
                || write_word == 5 && write_bytes[0] && write_data[0]);

    always @* if (!$initstate) begin
        // A request waits only for a computation. There is no answer without a request.
        if (write && !write_answer) assert (asks_start && start_waits);
        if (read && !read_answer) assert (is_result && result_waits);
        if (!write) assert (!write_answer);
        if (!read) assert (!read_answer);
        // A result is read only after the computation has ended.
        if (read_answer && is_result) assert (!result_waits);
        // An access is an error exactly if its address is not in the map or, for a write,
        // read-only.
        assert (write_error == !write_mapped);
        assert (read_error == (read_word >= WORDS));
        assert (dut.core.rst_n == rst_n);
        assert (irq == (dut.interrupt_enable && dut.interrupt_pending));
        // The core gets the operands that were written.
        assert (dut.core.cos_gamma == dut.operand_cos_gamma);
        assert (dut.core.exponent == dut.operand_exponent);
        assert (dut.core.red == dut.operand_red);
        assert (dut.core.green == dut.operand_green);
        assert (dut.core.blue == dut.operand_blue);
    end

    // Whether a register was written in the clock before, and the address of that write.
    reg took;
    reg [31:0] took_word;
    always @(posedge clk) begin
        took <= write_answer && !write_error;
        took_word <= write_word;
    end
    wire took_control = took && took_word == 5;
    wire took_enable = took && took_word == 6;
    wire took_pending = took && took_word == 7;
    always @(posedge clk) if (!$initstate && $past(!$initstate)) begin
        // In the clock after its request, a read shows all bits of its register: an operand as it
        // was written, and 0 for a result before the first computation has ended.
        if ($past(read_error)) assert (read_data == 0);
        if ($past(read_answer && is_result)) assert (!dut.core.run);
        if ($past(read_word) == 0) begin
            assert (read_data == {32'h474c4e54});
        end
        if ($past(read_word) == 1) begin
            assert (read_data == {32'd256});
        end
        if ($past(read_word) == 2) begin
            assert (read_data == {32'h30f154fd});
        end
        if ($past(read_word) == 3) begin
            assert (read_data == {16'd0, 8'd3, 8'd5});
        end
        if ($past(read_word) == 4) begin
            assert (read_data == {30'd0, dut.finished, dut.start | dut.core.run});
        end
        if ($past(read_word) == 5) begin
            assert (read_data == {20'd0, dut.start_word, 6'd0, dut.start_on_write, 1'b0});
        end
        if ($past(read_word) == 6) begin
            assert (read_data == {31'd0, dut.interrupt_enable});
        end
        if ($past(read_word) == 7) begin
            assert (read_data == {31'd0, dut.interrupt_pending});
        end
        if ($past(read_word) == 8) begin
            assert (read_data == {11'd0, dut.operand_cos_gamma});
        end
        if ($past(read_word) == 9) begin
            assert (read_data == {22'd0, dut.operand_exponent});
        end
        if ($past(read_word) == 10) begin
            assert (read_data == {24'd0, dut.operand_red});
        end
        if ($past(read_word) == 11) begin
            assert (read_data == {24'd0, dut.operand_green});
        end
        if ($past(read_word) == 12) begin
            assert (read_data == {24'd0, dut.operand_blue});
        end
        if ($past(read_word) == 13) begin
            assert (read_data == ($past(dut.finished) ? {8'd0, dut.core.blue_out,
                    dut.core.green_out, dut.core.red_out} : 0));
        end
    end
    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(rst_n)) begin
        // Each write that asks for a start starts one computation, and nothing else starts one.
        assert (dut.start == $past(write_answer && asks_start));
        // A write changes the enabled bytes of the addressed register, and nothing else.
        assert (dut.start_on_write == (took_control && $past(write_bytes[0])
                ? $past(write_data[1]) : $past(dut.start_on_write)));
        assert (dut.start_word == (took_control && $past(write_bytes[1])
                ? $past(write_data[11:8]) : $past(dut.start_word)));
        assert (dut.interrupt_enable == (took_enable && $past(write_bytes[0])
                ? $past(write_data[0]) : $past(dut.interrupt_enable)));
        assert (dut.interrupt_pending == ($past(ended)
                || $past(dut.interrupt_pending)
                && !(took_pending && $past(write_bytes[0] && write_data[0]))));
        assert (dut.finished == ($past(ended) || $past(dut.finished) && !$past(dut.start)));
        if (took && took_word == 8 && $past(write_bytes[0])) begin
            assert (dut.operand_cos_gamma[7:0] == $past(write_data[7:0]));
        end else begin
            assert ($stable(dut.operand_cos_gamma[7:0]));
        end
        if (took && took_word == 8 && $past(write_bytes[1])) begin
            assert (dut.operand_cos_gamma[15:8] == $past(write_data[15:8]));
        end else begin
            assert ($stable(dut.operand_cos_gamma[15:8]));
        end
        if (took && took_word == 8 && $past(write_bytes[2])) begin
            assert (dut.operand_cos_gamma[20:16] == $past(write_data[20:16]));
        end else begin
            assert ($stable(dut.operand_cos_gamma[20:16]));
        end
        if (took && took_word == 9 && $past(write_bytes[0])) begin
            assert (dut.operand_exponent[7:0] == $past(write_data[7:0]));
        end else begin
            assert ($stable(dut.operand_exponent[7:0]));
        end
        if (took && took_word == 9 && $past(write_bytes[1])) begin
            assert (dut.operand_exponent[9:8] == $past(write_data[9:8]));
        end else begin
            assert ($stable(dut.operand_exponent[9:8]));
        end
        if (took && took_word == 10 && $past(write_bytes[0])) begin
            assert (dut.operand_red == $past(write_data[7:0]));
        end else begin
            assert ($stable(dut.operand_red));
        end
        if (took && took_word == 11 && $past(write_bytes[0])) begin
            assert (dut.operand_green == $past(write_data[7:0]));
        end else begin
            assert ($stable(dut.operand_green));
        end
        if (took && took_word == 12 && $past(write_bytes[0])) begin
            assert (dut.operand_blue == $past(write_data[7:0]));
        end else begin
            assert ($stable(dut.operand_blue));
        end
    end
endmodule

`default_nettype wire
