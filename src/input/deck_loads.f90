!> BOUNDARY, CLOAD, DLOAD and DSLOAD to the loads of each step.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `load_propagation` determines how long they act.
module amontons_deck_loads
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_integer
  use amontons_card_schema, only: has_parameter, parameter_word
  use amontons_deck_surfaces, only: face_number
  use amontons_deck_submodel, only: read_global_step, check_driven_nodes, check_driven_dofs
  use amontons_deck_structure, only: is_shell, structural_face, OTHER_LAYER
  use amontons_deck_reader, only: reader_type, support_dofs, open_card, report_error, &
    report_note, read_real, read_integer, check_n_fields, &
    nodes_of_field, elements_of_field, find_amplitude, is_card
  use amontons_containers, only: name_table_type
  use amontons_deck_beam_loads, only: is_beam, read_line_load
  use amontons_loads, only: prescribed_type, has_integral, DISTRIBUTED_GRAVITY, DISTRIBUTED_CENTRIFUGAL, &
    DISTRIBUTED_BODY_FORCE, DISTRIBUTED_TRACTION
  use amontons_materials, only: material_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_structural_data, only: find_node_directors, force_weights
  use amontons_load_propagation, only: active_loads_type, load_region_type, add_load, ramp_down_loads, prescribe_dof, &
    find_or_add_place, has_other_rotation, release_prescribed, &
    LOAD_CLOAD, LOAD_DLOAD, LOAD_VOLUME
  use amontons_mesh, only: mean_face_normal, numbered_face, face_number_here
  use amontons_text, only: name_key, to_text, plural, verb, is_one_of, NUMBER_OK
  use amontons_element_kinds, only: element_kind_type, element_kind, kind_family, is_of_revolution, FAMILY_SOLID, &
    has_faces_in_space
  implicit none
  private
  public :: read_boundary, read_cload, read_dload, map_dof

contains

  !> Reports that CalculiX applies a load twice to a member that a set names twice.
  subroutine report_set_repeats(reader, row, names, has_repeats)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(name_table_type), intent(in) :: names
    logical, intent(in) :: has_repeats(:)        !< (sets)
    character(:), allocatable :: name
    integer :: s
    if (reader%dialect /= DIALECT_CALCULIX) return
    name = field_text(reader%cards, row, 1)
    s = names%find(name)
    if (s == 0) return
    if (has_repeats(s)) call report_note(reader, row%line, 'The deck names some members of the set ''' // name // ''' more than ' &
      // &
      'once. Here the load acts on each of them once; CalculiX applies it as often as they are named.')
  end subroutine report_set_repeats


  !> BOUNDARY in the model (step 0) or in the current step.
  subroutine read_boundary(reader, model, c, step, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: step                  !< present step; 0: the model
    type(active_loads_type), intent(inout) :: active_loads
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(prescribed_type) :: common
    integer :: n_changed
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') call release_prescribed(step, active_loads)
    call find_amplitude(reader, c, parameters, common%amplitude)
    common%is_held = has_parameter(parameters, 'FIXED')
    common%is_user = has_parameter(parameters, 'USER')
    if (common%is_user .and. (common%is_held .or. has_parameter(parameters, 'AMPLITUDE'))) call report_error(reader, &
      reader%cards%cards(c)%line, 'With USER the routine DISP gives the displacements, without AMPLITUDE or FIXED.')
    common%is_velocity = parameter_word(parameters, 'TYPE', 'DISPLACEMENT') == 'VELOCITY'
    if (common%is_velocity) call check_velocity(reader, model, c, common)
    call read_global_step(reader, c, parameters, step, common%global_step)
    common%is_time_scaled = has_parameter(parameters, 'TIMESCALE')
    if (has_parameter(parameters, 'SUBMODEL') .and. common%global_step == 0) return      ! reported
    n_changed = 0
    do while (next_row(reader%cards, row))
      call read_boundary_row(reader, model, row, step, common, active_loads, n_changed)
    end do
    if (n_changed > 0) call report_note(reader, reader%cards%cards(c)%line, plural(n_changed, 'displacement') // &
      ' of this step had another value by an earlier line; the later one counts.')
  end subroutine read_boundary


  !> Reports what a prescribed velocity cannot have.
  subroutine check_velocity(reader, model, c, common)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(prescribed_type), intent(in) :: common  !< with amplitude, is_held, is_user
    if (common%is_held .or. common%is_user) call report_error(reader, reader%cards%cards(c)%line, &
      'TYPE=VELOCITY cannot be combined with FIXED or USER.')
    if (common%amplitude == 0) return
    if (.not. has_integral(model%amplitudes(common%amplitude))) call report_error(reader, reader%cards%cards(c)%line, &
      'The amplitude of a velocity must be a table (TABULAR or SMOOTH STEP), which has an integral over time.')
  end subroutine check_velocity


  !> One row of BOUNDARY.
  subroutine read_boundary_row(reader, model, row, step, common, active_loads, n_changed)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: step
    type(prescribed_type), intent(in) :: common  !< with amplitude and is_held
    type(active_loads_type), intent(inout) :: active_loads
    integer, intent(inout) :: n_changed          !< displacements given differently before in this step
    type(prescribed_type) :: new
    integer, allocatable :: nodes(:)
    logical :: is_fixed(6), is_ok, is_word
    integer :: i, dof, n_passed
    is_ok = .true.
    new = common
    new%line = reader%cards%line_number(row%line)
    call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
    call read_dofs(reader, row, is_fixed, new%end, is_word, is_ok)
    if (is_ok .and. common%global_step /= 0) then
      call check_driven_nodes(reader, model, row, nodes, is_ok)
      if (is_ok) call check_driven_dofs(reader, model, row, nodes, is_fixed, new%end, is_ok)
    end if
    if (.not. is_ok) return
    n_passed = 0
    do i = 1, size(nodes)
      do dof = 1, 6
        if (.not. is_fixed(dof)) cycle
        call map_dof(model, nodes(i), dof, new%node, new%dof)
        if (new%node == 0) n_passed = n_passed + 1
        if (new%node > 0) call prescribe_dof(new, step, active_loads, n_changed)
      end do
    end do
    if (n_passed == 0 .or. is_word) return
    if (abs(new%end) > 0) then
      call report_error(reader, row%line, 'The nodes of solids have no rotations; the degrees of freedom are 1 to 3 (4 to 6 ' // &
        'at reference nodes of rigid bodies and couplings).')
    else
      call report_note(reader, row%line, 'The nodes of solids have no rotations; the degrees of freedom 4 to 6 are passed over.')
    end if
  end subroutine read_boundary_row


  !> The node and direction of a degree of freedom: 4 to 6 of a reference node are the displacements of its rotation node.
  subroutine map_dof(model, node, dof, place, dof_there)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, dof             !< 1 to 6
    integer, intent(out) :: place, dof_there     !< node and 1 to 3; node 0: not found
    place = node
    dof_there = dof
    if (dof <= 3) return
    dof_there = dof - 3
    place = 0
    if (allocated(model%rotation_of)) place = model%rotation_of(node)
  end subroutine map_dof


  !> The degrees of freedom of a BOUNDARY row: first, last, value; or a word.
  subroutine read_dofs(reader, row, is_fixed, value, is_word, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    logical, intent(out) :: is_fixed(6)
    real(DP), intent(out) :: value               !< [length]
    logical, intent(out) :: is_word              !< the row names a support, such as ENCASTRE
    logical, intent(inout) :: is_ok
    integer :: first, last, status
    is_fixed = .false.
    value = 0
    call field_integer(reader%cards, row, 2, first, status)
    is_word = status /= NUMBER_OK
    if (is_word) then
      call read_support_word(reader, row, is_fixed, is_ok)
      return
    end if
    call check_n_fields(reader, row, 4)
    call read_integer(reader, row, 3, 'last degree of freedom', last, is_ok, default=first)
    call read_real(reader, row, 4, 'displacement', value, is_ok, 0.0_DP)
    if (.not. is_ok) return
    if (first == 11 .and. last == 11) then
      call report_error(reader, row%line, 'The degree of freedom 11 is the temperature, which belongs to a flow of heat; ' // &
        '*TEMPERATURE prescribes temperatures.')
      is_ok = .false.
    else if (first < 1 .or. last < first .or. last > 6) then
      call report_error(reader, row%line, 'The degrees of freedom must be 1 to 3 (to 6 at reference nodes), the first not ' // &
        'above the last.')
      is_ok = .false.
    else
      is_fixed(first:last) = .true.
    end if
  end subroutine read_dofs


  !> Expands a word such as PINNED or XSYMM. Nodes without rotations ignore its degrees of freedom 4 to 6.
  subroutine read_support_word(reader, row, is_fixed, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    logical, intent(out) :: is_fixed(6)
    logical, intent(inout) :: is_ok
    call check_n_fields(reader, row, 2)
    is_fixed = support_dofs(field_text(reader%cards, row, 2))
    if (any(is_fixed)) return
    is_ok = .false.
    call report_error(reader, row%line, 'The second field must be the first degree of freedom, or ENCASTRE, PINNED, ' // &
      'XSYMM, YSYMM, ZSYMM, XASYMM, YASYMM or ZASYMM; it is ''' // field_text(reader%cards, row, 2) // '''.')
  end subroutine read_support_word


  !> CLOAD in the current step.
  subroutine read_cload(reader, model, c, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(active_loads_type), intent(inout) :: active_loads
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    real(DP) :: value
    integer :: amplitude, dof, i, place, dof_there
    logical :: is_ok, is_follower, is_planar
    call open_card(reader, c, parameters, row)
    is_follower = has_parameter(parameters, 'FOLLOWER')
    is_planar = all(model%mesh%is_unstiffened(3, :) .or. .not. model%mesh%has_elements)
    if (is_follower .and. model%dialect == DIALECT_CALCULIX) then
      call report_note(reader, reader%cards%cards(c)%line, 'CalculiX has no FOLLOWER and passes over it; so does this ' // &
        'dialect: the forces keep their direction.')
      is_follower = .false.
    end if
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') call &
      ramp_down_loads(active_loads%step, active_loads%is_step, model%dialect, active_loads%has_new(LOAD_CLOAD), active_loads%cloads)
    call find_amplitude(reader, c, parameters, amplitude)
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call check_n_fields(reader, row, 3)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call read_integer(reader, row, 2, 'degree of freedom', dof, is_ok)
      call read_real(reader, row, 3, 'force', value, is_ok, 0.0_DP)
      call report_set_repeats(reader, row, reader%node_sets, reader%node_set_repeats)
      if (is_ok .and. (dof < 1 .or. dof > 6)) then
        call report_error(reader, row%line, 'The degree of freedom of a force must be 1, 2 or 3, of a moment 4, 5 or 6.')
        is_ok = .false.
      else if (is_ok .and. is_follower .and. dof > 3 .and. .not. is_planar) then
        call report_error(reader, row%line, 'FOLLOWER turns forces, degrees of freedom 1 to 3. A moment about the axis of the ' // &
          'rotation is the same without it.')
        is_ok = .false.
      end if
      if (.not. is_ok) cycle
      do i = 1, size(nodes)
        call map_dof(model, nodes(i), dof, place, dof_there)
        if (place == 0) then
          call report_error(reader, row%line, 'The nodes of solids take no moments; only reference nodes of rigid bodies ' // &
            'and couplings do.')
          exit
        end if
        if (is_follower .and. dof <= 3) then   ! in the plane a moment keeps its axis
          call add_load(3 * (model%mesh%n_nodes + place) - 3 + dof_there, value, amplitude, active_loads%step, &
            active_loads%is_step, active_loads%cloads)
        else
          call add_node_force(model, place, dof_there, value, amplitude, active_loads)
        end if
      end do
    end do
  end subroutine read_cload


  !> A force on a node; on one of a shell with a single fibre, on the nodes of the fibre.
  subroutine add_node_force(model, node, dof, value, amplitude, active_loads)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, dof             !< 1 to 3
    real(DP), intent(in) :: value
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    real(DP), allocatable :: weight(:)
    integer :: first, last, i
    logical :: is_turned
    last = 0
    first = 1
    is_turned = .false.                          ! a transformed node: its loads are kept by its directions
    if (allocated(model%frame_of)) is_turned = model%frame_of(node) > 0
    if (allocated(model%structure) .and. .not. is_turned) call find_node_directors(model%structure, node, first, last)
    if (last == first) then
      weight = force_weights(model%structure%directors(first), model%dialect == DIALECT_CALCULIX, &
        model%structure%is_constrained(dof, node))
      if (model%rotation_of(node) > 0 .and. model%dialect /= DIALECT_CALCULIX) weight = 0   ! a knot
    end if
    if (last /= first) weight = [0.0_DP]
    if (.not. sum(weight) > 0) then
      call add_load(3 * node - 3 + dof, value, amplitude, active_loads%step, active_loads%is_step, active_loads%cloads)
      return
    end if
    associate (nodes => model%structure%directors(first)%nodes)
      do i = 1, size(nodes)
        if (abs(weight(i)) > 0) call add_load(3 * nodes(i) - 3 + dof, value * weight(i), amplitude, active_loads%step, &
          active_loads%is_step, active_loads%cloads)
      end do
    end associate
  end subroutine add_node_force


  !> DLOAD or DSLOAD in the current step.
  subroutine read_dload(reader, model, c, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(active_loads_type), intent(inout) :: active_loads
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: label
    integer :: amplitude
    logical :: is_following, is_constant
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') then
      call ramp_down_loads(active_loads%step, active_loads%is_step, model%dialect, active_loads%has_new(LOAD_DLOAD), &
        active_loads%pressures)
      call ramp_down_loads(active_loads%step, active_loads%is_step, model%dialect, active_loads%has_new(LOAD_VOLUME), &
        active_loads%volumes)
    end if
    call find_amplitude(reader, c, parameters, amplitude)
    is_following = parameter_word(parameters, 'FOLLOWER', 'YES') == 'YES'
    is_constant = parameter_word(parameters, 'CONSTANT RESULTANT', 'NO') == 'YES'
    do while (next_row(reader%cards, row))
      label = name_key(field_text(reader%cards, row, 2))
      if (is_by_user(label) .and. amplitude > 0) call report_error(reader, row%line, 'The routine ' // trim(merge('UTRACLOAD', &
        'DLOAD    ', is_traction(label))) // ' gives the whole load; AMPLITUDE must not be given with ' // label // '.')
      if (.not. is_following .and. .not. is_traction(label)) call report_error(reader, row%line, &
        'FOLLOWER=NO is for TRVEC and TRSHR; a pressure follows its face.')
      if (is_shell_load(reader, c, row, label)) then
        call read_face_pressure(reader, model, row, amplitude, active_loads)
      else if (label == 'P' .or. label == 'PNU') then
        call read_surface_pressure(reader, model, row, amplitude, active_loads)
      else if (is_card(reader, c, 'DSLOAD') .and. is_one_of(strip_nu(label), 'TRVEC|TRSHR') .or. (is_card(reader, c, 'DLOAD') &
          .and. reader%dialect /= DIALECT_CALCULIX .and. is_traction(label))) then
        call read_traction(reader, model, row, amplitude, is_following .or. .not. is_constant, active_loads)
      else if (is_card(reader, c, 'DSLOAD')) then
        call report_error(reader, row%line, 'The second field must be P, a pressure, PNU, one by the routine DLOAD, TRVEC, a ' // &
          'force per area in a direction, or TRSHR, its part along the surface (with NU: by the routine UTRACLOAD); it is ''' // &
          label // '''.')
      else if (face_number(strip_nu(label), 'P') > 0) then
        call read_face_pressure(reader, model, row, amplitude, active_loads)
      else if (reader%dialect /= DIALECT_CALCULIX .and. is_one_of(label, 'PX|PY|PZ')) then
        call read_line_load(reader, model, row, amplitude, active_loads)
      else if (reader%dialect == DIALECT_CALCULIX .and. is_one_of(label, 'P1NP|P2NP|P3NP|P4NP|P5NP|P6NP')) then
        call read_node_pressure(reader, model, row, active_loads)
      else if (is_one_of(label, 'GRAV|CENTRIF|BX|BY|BZ|BR')) then
        call read_volume_load(reader, model, row, amplitude, active_loads)
      else
        call report_error(reader, row%line, 'The second field must be P1 to P6 (pressure on a face), P (pressure on a ' // &
          'surface), each with NU for one by the routine DLOAD, P1NP to P6NP (calculix dialect: that of a node), GRAV ' // &
          '(gravity), CENTRIF (rotation), BX, BY, BZ, BR (force per volume), TRVECn, TRSHRn (abaqus dialect: traction on face n) ' &
          // 'or, on beams, P1, P2 or (abaqus dialect) PX, PY, PZ (force per length); it is ''' // label // '''.')
      end if
    end do
  end subroutine read_dload


  !> Whether a label is a traction: TRVEC or TRSHR, of DLOAD with the number of a face and perhaps NU.
  pure logical function is_traction(label)
    character(*), intent(in) :: label            !< squeezed
    is_traction = index(label, 'TRVEC') == 1 .or. index(label, 'TRSHR') == 1
  end function is_traction


  !> Whether a row of DLOAD is a load of shells: P on elements instead of a surface, or EDNORn.
  logical function is_shell_load(reader, c, row, label)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: label            !< squeezed
    integer :: number, status
    is_shell_load = .false.
    if (.not. is_card(reader, c, 'DLOAD')) return
    if (is_one_of(label, 'EDNOR1|EDNOR2|EDNOR3|EDNOR4')) is_shell_load = .true.
    if (.not. (label == 'P' .or. label == 'PNU') .or. reader%surfaces%find(field_text(reader%cards, row, 1)) > 0) return
    call field_integer(reader%cards, row, 1, number, status)
    is_shell_load = status == NUMBER_OK .or. reader%element_sets%find(field_text(reader%cards, row, 1)) > 0
  end function is_shell_load


  !> Whether a label of DLOAD ends with NU: the user routine DLOAD gives the pressure.
  pure logical function is_by_user(label)
    character(*), intent(in) :: label            !< squeezed
    is_by_user = len(strip_nu(label)) < len(label)
  end function is_by_user


  !> A label without NU at its end.
  pure function strip_nu(label) result(short)
    character(*), intent(in) :: label
    character(:), allocatable :: short
    short = name_key(label)
    if (len(short) < 3) return
    if (short(len(short) - 1:) == 'NU') short = short(:len(short) - 2)
  end function strip_nu


  !> Reports faces of plane elements that DLOAD does not support.
  subroutine check_solid_faces(reader, model, row, e)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: e                     !< element
    if (.not. has_faces_in_space(model%mesh%kind(e))) call report_error(reader, row%line, 'The routine DLOAD is for the faces ' &
      // 'of solids in space.')
  end subroutine check_solid_faces


  !> Row: surface, P, pressure.
  subroutine read_surface_pressure(reader, model, row, amplitude, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    real(DP) :: value
    integer :: s, i
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    call read_real(reader, row, 3, 'pressure', value, is_ok, 0.0_DP)
    call find_faces(reader, model, row, s)
    if (s == 0 .or. .not. is_ok) return
    do i = 1, size(model%surfaces(s)%element)
      call add_load(6 * model%surfaces(s)%element(i) - 6 + model%surfaces(s)%face(i), value, amplitude, &
        active_loads%step, active_loads%is_step, active_loads%pressures, is_by_user(field_text(reader%cards, row, 2)))
    end do
    if (is_by_user(field_text(reader%cards, row, 2)) .and. size(model%surfaces(s)%element) > 0) &
      call check_solid_faces(reader, model, row, model%surfaces(s)%element(1))
  end subroutine read_surface_pressure


  !> The element surface named by the first field; 0: not found, an error is reported.
  subroutine find_faces(reader, model, row, s)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(out) :: s
    character(:), allocatable :: name
    name = field_text(reader%cards, row, 1)
    s = reader%surfaces%find(name)
    if (s == 0 .and. reader%element_sets%find(name) > 0) then
      call report_error(reader, row%line, '''' // name // ''' is a set of elements, no surface. Make one of its free faces, ' // &
        '*SURFACE, NAME=name with the line ' // name // ', and load that.')
    else if (s == 0) then
      call report_error(reader, row%line, 'There is no surface ''' // name // '''' // reader%surfaces%suggest(name))
    else if (model%surfaces(s)%is_node_based) then
      call report_error(reader, row%line, 'The surface ''' // model%surfaces(s)%name // &
        ''' is made of nodes; a pressure needs element faces.')
      s = 0
    end if
  end subroutine find_faces


  !> Row: surface, TRVEC or TRSHR, or element or element set, TRVECn or TRSHRn; magnitude, direction.
  subroutine read_traction(reader, model, row, amplitude, is_following, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    logical, intent(in) :: is_following          !< default: the traction rotates with its face, per current area
    type(active_loads_type), intent(inout) :: active_loads
    type(load_region_type) :: place
    type(element_kind_type) :: entry
    character(:), allocatable :: label
    real(DP) :: value
    integer :: i
    logical :: is_ok
    is_ok = .true.
    label = name_key(field_text(reader%cards, row, 2))
    call check_n_fields(reader, row, 6)
    call read_real(reader, row, 3, 'magnitude', value, is_ok, 0.0_DP)
    do i = 1, 3
      call read_real(reader, row, i + 3, 'direction', place%direction(i), is_ok, 0.0_DP)
    end do
    place%is_user = is_by_user(label)
    if (is_one_of(strip_nu(label), 'TRVEC|TRSHR')) then
      call find_surface_place(reader, model, row, place, is_ok)
    else
      call find_face_place(reader, model, row, label, place, is_ok)
    end if
    if (.not. is_ok) return
    if (.not. norm2(place%direction) > 0 .and. .not. place%is_user) then
      call report_error(reader, row%line, 'The direction must not be zero: surface, TRVEC or TRSHR, magnitude, x, y, z.')
      return
    end if
    place%kind = DISTRIBUTED_TRACTION
    if (norm2(place%direction) > 0) place%direction = place%direction / norm2(place%direction)
    place%is_follower = is_following
    do i = 1, size(place%elements)
      entry = element_kind(model%mesh%kind(place%elements(i)))
      if (has_faces_in_space(model%mesh%kind(place%elements(i))) .or. .not. abs(place%direction(3)) > 0) cycle
      call report_error(reader, row%line, 'Plane and axisymmetric elements take no traction out of the plane.')
      return
    end do
    if (place%is_user) then
      place%is_shear = index(label, 'TRSHR') == 1
      call check_user_traction(reader, model, row, place, is_ok)
    else if (index(label, 'TRSHR') == 1) then
      call project_on_faces(reader, model, row, place, is_ok)
    end if
    if (is_ok) call add_region_load(place, value, amplitude, active_loads)
  end subroutine read_traction


  !> The faces of the surface that a traction of DSLOAD acts on; DLOAD takes elements.
  subroutine find_surface_place(reader, model, row, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(load_region_type), intent(inout) :: place   !< out: region, elements, faces
    logical, intent(inout) :: is_ok
    integer :: s
    call find_faces(reader, model, row, s)
    is_ok = is_ok .and. s > 0
    if (.not. is_ok) return
    place%region = name_key(field_text(reader%cards, row, 1))
    place%surface = s
    place%elements = model%surfaces(s)%element
    place%faces = model%surfaces(s)%face
  end subroutine find_surface_place


  !> The faces n of elements that TRVECn or TRSHRn of DLOAD acts on; all of them must have it.
  subroutine find_face_place(reader, model, row, label, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: label            !< squeezed
    type(load_region_type), intent(inout) :: place   !< out: region, elements, faces
    logical, intent(inout) :: is_ok
    character(:), allocatable :: short
    integer :: i
    if (.not. is_ok) return
    short = strip_nu(label)
    call elements_of_field(reader, model%mesh, row, 1, place%elements, is_ok)
    if (.not. is_ok) return
    call report_set_repeats(reader, row, reader%element_sets, reader%element_set_repeats)
    allocate (place%faces(size(place%elements)))
    do i = 1, size(place%elements)
      place%faces(i) = numbered_face(model%mesh, place%elements(i), face_number(short(5:), short(5:5)))
      is_ok = is_ok .and. place%faces(i) > 0
      if (allocated(model%structure)) is_ok = is_ok .and. model%structure%section(place%elements(i)) == 0
      if (is_ok) cycle
      call report_error(reader, row%line, 'Element ' // to_text(model%mesh%element_label(place%elements(i))) // ' takes no load ' &
        // label // ': n of TRVECn and TRSHRn is a face of a solid or plane element, 1 to 6. Shells take *DSLOAD on a surface.')
      return
    end do
    place%region = name_key(field_text(reader%cards, row, 1)) // ' ' // label
  end subroutine find_face_place


  !> Reports faces at which UTRACLOAD is not called: those of plane elements, and of shells, whose solids have other numbers.
  subroutine check_user_traction(reader, model, row, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(load_region_type), intent(in) :: place  !< with elements
    logical, intent(inout) :: is_ok
    integer :: i
    do i = 1, size(place%elements)
      is_ok = is_ok .and. kind_family(model%mesh%kind(place%elements(i))) == FAMILY_SOLID
      if (allocated(model%structure)) is_ok = is_ok .and. model%structure%section(place%elements(i)) == 0
      if (is_ok) cycle
      call report_error(reader, row%line, 'The routine UTRACLOAD is for the faces of solids in space; element ' // &
        to_text(model%mesh%element_label(place%elements(i))) // ' is none. Write TRVEC or TRSHR with magnitudes on sets of ' // &
        'faces.')
      return
    end do
  end subroutine check_user_traction


  !> TRSHR: the unit vectors of a direction projected on the faces, each with its mean normal.
  subroutine project_on_faces(reader, model, row, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(load_region_type), intent(inout) :: place    !< with elements, faces, direction
    logical, intent(inout) :: is_ok
    real(DP), parameter :: MIN_SHEAR_PART = 1.0e-6_DP      ! of a unit vector along a face [-]
    real(DP) :: normal(3), along(3)
    integer :: i
    allocate (place%face_directions(3, size(place%faces)))
    do i = 1, size(place%faces)
      normal = mean_face_normal(model%mesh, place%elements(i), place%faces(i))
      along = place%direction - dot_product(place%direction, normal) * normal
      if (norm2(along) < MIN_SHEAR_PART) then
        call report_error(reader, row%line, 'The direction of TRSHR is normal to face S' // to_text(place%faces(i)) // &
          ' of element ' // to_text(model%mesh%element_label(place%elements(i))) // ': a shear traction needs a part along it.')
        is_ok = .false.
        return
      end if
      place%face_directions(:, i) = along / norm2(along)
    end do
  end subroutine project_on_faces


  !> Row: element or element set, P1 to P6, pressure.
  subroutine read_face_pressure(reader, model, row, amplitude, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    integer, allocatable :: elements(:)
    character(:), allocatable :: label
    real(DP) :: value
    integer :: face, i, n_without
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    call read_real(reader, row, 3, 'pressure', value, is_ok, 0.0_DP)
    if (.not. is_ok) return
    call report_set_repeats(reader, row, reader%element_sets, reader%element_set_repeats)
    label = name_key(field_text(reader%cards, row, 2))
    if (is_one_of(label, 'P1|P2') .and. any([(is_beam(model, elements(i)), i=1, size(elements))])) then
      call read_line_load(reader, model, row, amplitude, active_loads)
      return
    end if
    if (is_by_user(field_text(reader%cards, row, 2)) .and. size(elements) > 0) call check_solid_faces(reader, model, row, &
      elements(1))
    n_without = 0
    do i = 1, size(elements)
      face = numbered_face(model%mesh, elements(i), face_number(strip_nu(label), 'P'))
      if (is_shell(model, elements(i))) then
        face = structural_face(model, elements(i), label)
      else if (allocated(model%structure)) then
        if (model%structure%section(elements(i)) > 0) face = 0
      end if
      if (face == OTHER_LAYER) cycle
      if (face == 0) then
        n_without = n_without + 1
      else
        call add_load(6 * elements(i) - 6 + face, value * pressure_factor(model, elements(i), label), amplitude, &
          active_loads%step, active_loads%is_step, active_loads%pressures, is_by_user(field_text(reader%cards, row, 2)))
      end if
    end do
    if (n_without > 0) call report_error(reader, row%line, plural(n_without, 'element') // ' here ' // &
      verb(n_without, 'takes', 'take') // ' no load ' // label // '; tetrahedra have 4 faces (P1 to P4), wedges 5, ' // &
      'hexahedra 6; shells take P and EDNOR1 to EDNOR4, beams P1 and P2, those by their section *CLOAD at their nodes.')
  end subroutine read_face_pressure


  !> Row: element or element set, P1NP to P6NP, node: the pressure is the second displacement prescribed at this node, the
  !! pressure of a gas in CalculiX.
  subroutine read_node_pressure(reader, model, row, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(active_loads_type), intent(inout) :: active_loads
    integer, allocatable :: elements(:), nodes(:)
    character(:), allocatable :: label
    integer :: face, i
    logical :: is_ok, has_face
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    call nodes_of_field(reader, model%mesh, row, 3, nodes, is_ok)
    if (.not. is_ok) return
    call report_set_repeats(reader, row, reader%element_sets, reader%element_set_repeats)
    label = name_key(field_text(reader%cards, row, 2))
    has_face = size(nodes) == 1
    do i = 1, size(elements)
      face = numbered_face(model%mesh, elements(i), face_number(label(:2), 'P'))
      has_face = has_face .and. face > 0
      if (allocated(model%structure)) has_face = has_face .and. model%structure%section(elements(i)) == 0
      if (has_face) call add_load(6 * elements(i) - 6 + face, 0.0_DP, 0, active_loads%step, active_loads%is_step, &
        active_loads%pressures, node=nodes(1))
    end do
    if (.not. has_face) call report_error(reader, row%line, 'P1NP to P6NP need one node, and elements of solids with this face.')
  end subroutine read_node_pressure


  !> The pressure on a face over the value of the load: of EDNORn, a force per length, the inverse of the thickness.
  pure real(DP) function pressure_factor(model, e, label) result(factor)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element
    character(*), intent(in) :: label            !< squeezed
    integer :: k, n
    factor = 1
    if (index(label, 'EDNOR') == 0) return
    associate (structure => model%structure)
      n = structure%first(e + 1) - structure%first(e)
      if (n > 4) n = n / 2
      k = face_number_here(model%mesh, e, iachar(label(6:6)) - iachar('0')) - 1
      associate (of => structure%director_of(structure%first(e) + [k, modulo(k + 1, n)]))
        factor = 2 / sum(structure%directors(of)%thickness(1))
      end associate
    end associate
  end function pressure_factor


  !> Row: element or element set; GRAV, acceleration, direction; or CENTRIF, square of the angular velocity, point and
  !! direction of the axis; or BX, BY or BZ, force per volume.
  subroutine read_volume_load(reader, model, row, amplitude, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    type(load_region_type) :: place
    real(DP) :: value
    integer :: i
    logical :: is_ok
    is_ok = .true.
    if (field_text(reader%cards, row, 1) == '') then      ! as Abaqus/CAE writes a load on the whole model
      place%elements = [(i, i=1, model%mesh%n_elements)]
    else
      call elements_of_field(reader, model%mesh, row, 1, place%elements, is_ok)
    end if
    call read_real(reader, row, 3, 'magnitude', value, is_ok, 0.0_DP)
    call read_axis(reader, model, row, place, is_ok)
    if (.not. is_ok) return
    if (place%kind == DISTRIBUTED_CENTRIFUGAL .and. value < 0) then
      call report_error(reader, row%line, 'CENTRIF needs the square of the angular velocity, which is not negative.')
      return
    end if
    place%region = name_key(field_text(reader%cards, row, 1))
    call check_section_beams(reader, model, row, place%elements)
    if (place%kind /= DISTRIBUTED_BODY_FORCE) call check_density(reader, model, row, place, value)
    call add_region_load(place, value, amplitude, active_loads)
    if (reader%dialect /= DIALECT_CALCULIX) return
    if (.not. has_other_rotation(active_loads, place)) return
    call report_note(reader, row%line, 'Some of these elements have a rotation by another line already (another axis or set): ' // &
      'here all that are active act together; CalculiX applies one of them alone, and none where OP=NEW has removed that one.')
  end subroutine read_volume_load


  !> Reports beams by their section, which have no volume.
  subroutine check_section_beams(reader, model, row, elements)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: elements(:)
    logical :: is_loaded(model%mesh%n_elements)
    integer :: i
    if (.not. allocated(model%user_elements)) return
    is_loaded = .false.
    is_loaded(elements) = .true.
    do i = 1, size(model%user_elements%elements)
      associate (beam => model%user_elements%elements(i))
        if (.not. (model%user_elements%kinds(beam%kind)%is_beam .and. is_loaded(beam%element))) cycle
        call report_error(reader, row%line, 'The element ' // to_text(model%mesh%element_label(beam%element)) // ' is a beam ' // &
          'by its section, on which gravity, rotation and forces per volume do not act: put its ' // &
          'weight on its nodes by *CLOAD, and name the other elements here.')
        return
      end associate
    end do
  end subroutine check_section_beams


  !> Adds a load to those at the same place.
  subroutine add_region_load(place, value, amplitude, active_loads)
    type(load_region_type), intent(in) :: place
    real(DP), intent(in) :: value
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    integer :: i
    call find_or_add_place(active_loads, place, i)
    call add_load(i, value, amplitude, active_loads%step, active_loads%is_step, active_loads%volumes, place%is_user)
  end subroutine add_region_load


  !> The direction of a body force: x, y or z; for axisymmetric elements BR is along x and, under the abaqus dialect, BZ along y,
  !! the axis.
  subroutine find_body_direction(reader, model, row, letter, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    character(1), intent(in) :: letter           !< X, Y, Z or R
    type(load_region_type), intent(inout) :: place    !< with elements
    logical, intent(inout) :: is_ok
    integer :: i, n_round
    n_round = 0
    do i = 1, size(place%elements)
      if (is_of_revolution(model%mesh%kind(place%elements(i)))) n_round = n_round + 1
    end do
    if (letter == 'R') then
      place%direction(1) = 1
      if (n_round == size(place%elements)) return
      call report_error(reader, row%line, 'BR, a radial force per volume, is for axisymmetric elements.')
      is_ok = .false.
    else if (letter == 'Z' .and. n_round > 0 .and. reader%dialect /= DIALECT_CALCULIX) then
      place%direction(2) = 1
      if (n_round == size(place%elements)) return
      call report_error(reader, row%line, 'BZ acts along the axis of axisymmetric elements, but not all elements here are of ' // &
        'that kind; write a line for each.')
      is_ok = .false.
    else
      place%direction(index('XYZ', letter)) = 1
    end if
  end subroutine find_body_direction


  !> The direction of a load on volumes, preceded by a point of the axis for CENTRIF.
  subroutine read_axis(reader, model, row, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(load_region_type), intent(inout) :: place    !< with elements
    logical, intent(inout) :: is_ok
    character(:), allocatable :: label
    integer :: i, first
    label = name_key(field_text(reader%cards, row, 2))
    first = 4
    if (label(1:1) == 'B') then
      call check_n_fields(reader, row, 3)
      place%kind = DISTRIBUTED_BODY_FORCE
      call find_body_direction(reader, model, row, label(2:2), place, is_ok)
      return
    end if
    if (label == 'CENTRIF') then
      place%kind = DISTRIBUTED_CENTRIFUGAL
      first = 7
      do i = 1, 3
        call read_real(reader, row, i + 3, 'point of the axis', place%point(i), is_ok, 0.0_DP)
      end do
    end if
    call check_n_fields(reader, row, first + 2)
    do i = 1, 3
      call read_real(reader, row, first + i - 1, 'direction', place%direction(i), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    is_ok = norm2(place%direction) > 0
    if (.not. is_ok) then
      call report_error(reader, row%line, 'The direction must not be zero: region, GRAV, acceleration, x, y, z; or ' // &
        'region, CENTRIF, square of the angular velocity, x, y, z of a point and x, y, z along the axis.')
      return
    end if
    place%direction = place%direction / norm2(place%direction)
    if (place%kind /= DISTRIBUTED_CENTRIFUGAL) return
    do i = 1, size(place%elements)
      if (.not. is_of_revolution(model%mesh%kind(place%elements(i)))) cycle
      if (abs(place%direction(2)) >= 1.0_DP - 1.0e-9_DP .and. .not. abs(place%point(1)) + abs(place%point(3)) > 0) cycle
      call report_error(reader, row%line, 'Axisymmetric elements turn about the y axis: the point must be on it, and the ' // &
        'direction along it.')
      is_ok = .false.
      return
    end do
  end subroutine read_axis


  !> Reports materials without a density in elements under gravity or rotation, and gravity in other units than the density.
  subroutine check_density(reader, model, row, place, value)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(load_region_type), intent(in) :: place
    real(DP), intent(in) :: value                !< of the load
    logical :: is_reported(size(model%materials))
    integer :: i, m
    is_reported = .false.
    do i = 1, size(place%elements)
      m = model%mesh%material(place%elements(i))
      if (m == 0) cycle
      if (is_reported(m)) cycle
      is_reported(m) = .true.
      if (model%materials(m)%has_density) then
        if (place%kind == DISTRIBUTED_GRAVITY) call report_gravity(reader, row, model%materials(m), value)
        cycle
      end if
      call report_error(reader, row%line, 'Gravity and rotation need a density; the material ''' // model%materials(m)%name // &
        ''' has no *DENSITY card.')
    end do
  end subroutine check_density


  !> Hints at gravity in m/s2 beside a density in t/mm3.
  subroutine report_gravity(reader, row, material, value)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: value                !< of the load
    real(DP), parameter :: METALS(2) = [1.0e3_DP, 2.0e6_DP]             ! [MPa]
    real(DP), parameter :: IN_T_PER_MM3 = 3.0e-8_DP, GRAVITY(2) = [9.7_DP, 9.9_DP]
    if (material%youngs_modulus < METALS(1) .or. material%youngs_modulus > METALS(2)) return
    if (material%density <= 0.0_DP .or. material%density >= IN_T_PER_MM3) return
    if (abs(value) <= GRAVITY(1) .or. abs(value) >= GRAVITY(2)) return
    call report_note(reader, row%line, 'The density of ''' // material%name // ''' is in N, mm, t, where gravity is 9810, ' // &
      'not ' // to_text(value) // '.')
  end subroutine report_gravity

end module amontons_deck_loads
