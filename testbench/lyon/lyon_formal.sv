// lyon_formal: properties of the handshake of lyon
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q lyon_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 8 lyon_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 8 lyon_formal.smt2
// or, with SymbiYosys,
//   $ sby -f lyon_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module lyon_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire start,
    input  wire [17:0] dx,
    input  wire dx_write,
    input  wire [17:0] dy,
    input  wire dy_write,
    input  wire [17:0] dz,
    input  wire dz_write,
    input  wire [3:0] shift,
    input  wire shift_write,
    input  wire [7:0] red,
    input  wire red_write,
    input  wire [7:0] green,
    input  wire green_write,
    input  wire [7:0] blue,
    input  wire blue_write
);
    wire       valid;
    wire       busy;
    wire       done;
    wire [7:0] red_out;
    wire [7:0] green_out;
    wire [7:0] blue_out;

    lyon dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .dx(dx),
        .dx_write(dx_write),
        .dy(dy),
        .dy_write(dy_write),
        .dz(dz),
        .dz_write(dz_write),
        .shift(shift),
        .shift_write(shift_write),
        .red(red),
        .red_write(red_write),
        .green(green),
        .green_write(green_write),
        .blue(blue),
        .blue_write(blue_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // The number of clocks since start.
    reg [6:0] age;
    always @(posedge clk) age <= busy ? age + 7'd1 : 7'd1;

    // The address of the current microinstruction, and the counters of loops.
    (* hierconn *) wire [2:0] \dut.control.word_address ;
    wire [2:0] word = \dut.control.word_address ;
    (* hierconn *) wire [3:0] \dut.datapath.remaining ;
    wire [3:0] remaining = \dut.datapath.remaining ;

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // After a reset the core is idle, whatever the state before it was.
            assert (!busy && !done);
        end else if (!$past(busy)) begin
            // The core is idle until start and busy from the clock after it.
            assert (busy == $past(start));
        end else begin
            // The core is busy up to the clock of done.
            assert (busy == !$past(done));
        end
        if (done) assert (busy);
        if (valid) assert (busy);
        if (busy) begin
            // Every computation ends in time: the clocks so far, plus the most clocks from the
            // current microinstruction to the end, are within the promised number.
            assert (age <= 7'd36);
            case (word)
                3'd0: assert (age + 7'd35 <= 7'd36);
                3'd1: assert (age + 7'd34 <= 7'd36);
                3'd2: assert (age + remaining + 7'd18 <= 7'd36);
                3'd3: assert (age + 7'd17 <= 7'd36);
                3'd4: assert (age + remaining + 7'd1 <= 7'd36);
                3'd5: assert (age <= 7'd36);
            endcase
        end
        // Every computation ends with a result.
        if (done) assert (valid);
    end
endmodule

`default_nettype wire
