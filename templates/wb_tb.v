
    reg cyc = 1'b0;
    reg stb = 1'b0;
    reg [31:0] adr = 32'd0;
    reg we = 1'b0;
    reg [31:0] dat = 32'd0;
    reg [3:0] sel = 4'd0;
    wire [31:0] dat_o;
    wire ack;
    wire err;
    ${ top }$ dut (
        .wb_clk_i(clk),
        .wb_rst_i(reset),
        .wb_cyc_i(cyc),
        .wb_stb_i(stb),
        .wb_we_i(we),
        .wb_adr_i(adr[${ address_high }$:0]),
        .wb_dat_i(dat),
        .wb_sel_i(sel),
        .wb_dat_o(dat_o),
        .wb_ack_o(ack),
        .wb_err_o(err),
        .irq(irq)
    );

    // Does the bus cycle that `access` asks for, after clocks in which only one of cyc and stb is
    // high.
    task do_access;
        begin
            adr = asked_address | {30'd0, random[9:8]};
            we = asked_write;
            dat = asked_data;
            sel = asked_bytes;
            repeat ({30'd0, random[1:0]}) begin
                cyc = random[2];
                stb = ~random[2];
                wait_a_clock;
                check(!ack && !err, "an answer without a request");
                @(negedge clk);
            end
            cyc = 1'b1;
            stb = 1'b1;
            while (!answered) begin
                wait_a_clock;
                check((ack & err) === 1'b0, "two answers");
                answered = ack | err;
                failed = err;
                got = dat_o;
                @(negedge clk);
            end
            // The next cycle may begin in the next clock.
            cyc = random[3];
            stb = 1'b0;
            we = random[4];
            adr = ~asked_address;
            dat = ~asked_data;
            sel = ~asked_bytes;
        end
    endtask
