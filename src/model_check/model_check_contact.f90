!> Model check of the contact pairs: projection, orientation of normals, initial penetration, common and supported nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_model_check_contact
  use amontons_kinds, only: DP
  use amontons_errors, only: diagnostic_list_type
  use amontons_text, only: to_text, plural, verb
  use amontons_containers, only: integer_list_type
  use amontons_element_kinds, only: element_kind, facet_kind, element_kind_type, facet_kind_type
  use amontons_loads, only: amplitude_type, prescribed_type
  use amontons_model, only: model_type, free_unknowns, DIALECT_CALCULIX
  use amontons_surfaces, only: is_compliant, is_self_contact, swap_advice
  use amontons_slave_node_overrides, only: gives_way
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_shared_slave_nodes, only: MIN_FREE_PART
  use amontons_contact_pairs, only: contact_type, SEARCH_RADIUS_RATIO
  use amontons_contact_initialization, only: TOL_INITIAL_CONTACT
  use amontons_rigid_exterior, only: rigid_bodies_type, collect_rigid_bodies
  use amontons_exterior_membership, only: find_tie_lines
  use amontons_model_check_bodies, only: report_error, report_warning, label_list, counted_noun
  implicit none
  private
  public :: pair_statistics_type, check_contact, collect_pair_statistics, is_closed, can_close_later

  real(DP), parameter :: MAX_COMPARED_GAP = 1.0_DP             !< normals are compared up to this gap over the edge of the facet [-]
  real(DP), parameter :: MIN_SAME_DIRECTION_COSINE = 0.5_DP         !< least product of normals of the same direction [-]
  real(DP), parameter :: MAX_PENETRATION = 0.5_DP             !< a larger penetration over the edge is an error [-]
  real(DP), parameter :: MIN_REPORTED_PENETRATION = 1.0e-3_DP        !< a larger penetration over the edge is reported [-]

  !> Statistics of the slave nodes of one pair at the start.
  type :: pair_statistics_type
    integer :: n_slaves = 0
    integer :: n_passive = 0                  !< besides these: inactive, in favour of another pair
    integer :: n_projected = 0                 !< that project on the master
    integer :: n_closed = 0                    !< that touch or penetrate
    integer :: n_facing_away = 0                    !< that project on the master and face the same way as it
    integer :: n_near = 0                      !< whose normal can be compared with that of the master
    integer :: n_same_direction = 0                   !< of these, that face the same way as the master
    integer :: n_held = 0                      !< with a support or an equation along the normal in step 1
    real(DP) :: least_gap = huge(1.0_DP)       !< of those that project and do not face away [length]
    real(DP) :: largest_gap = -huge(1.0_DP)    !< [length]
    real(DP) :: depth = 0                      !< largest penetration over the edge of the facet [-]
    integer :: deepest = 0                     !< its slave
  end type pair_statistics_type

contains

  !> Runs all checks of contact. Cost: linear in the nodes of the surfaces.
  subroutine check_contact(model, contact, slaves, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)      !< at the start of the first increment
    type(diagnostic_list_type), intent(inout) :: report
    type(pair_statistics_type), allocatable :: statistics(:)
    integer :: p
    call check_overlap(model, report)
    call check_self_contact_laws(model, report)
    call check_kinds(model, report)
    call collect_pair_statistics(model, contact, slaves, statistics)
    do p = 1, size(model%pairs)
      call check_projection(model, contact, p, statistics(p), report)
      call check_direction(model, p, statistics(p), report)
      call check_depth(model, contact, slaves, p, statistics(p), report)
    end do
    call check_held(model, contact, slaves(slaves_facing_master(contact, slaves)), report)
  end subroutine check_contact


  !> Counts and gaps of all pairs.
  subroutine collect_pair_statistics(model, contact, slaves, statistics)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(pair_statistics_type), allocatable, intent(out) :: statistics(:)   !< (n_pairs)
    logical, allocatable :: is_free(:, :)          ! (3, n_nodes)
    integer :: s
    allocate (statistics(size(model%pairs)))
    call find_free_unknowns(model, 1, is_free)
    do s = 1, size(slaves)
      associate (statistic => statistics(slaves(s)%pair))
        call count_slave(contact, slaves(s), contact%slave_normal(:, s), s, statistic)
        if (is_held_along(slaves(s), is_free(:, slaves(s)%node))) statistic%n_held = statistic%n_held + 1
      end associate
    end do
  end subroutine collect_pair_statistics


  !> Adds one slave node to the statistics. A node that faces away from the master, such as on the far side of a surface around a
  !! whole body, has no gap.
  pure subroutine count_slave(contact, slave, slave_normal, s, statistic)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: slave_normal(3)        !< outward; zero: unknown
    integer, intent(in) :: s                       !< number of the slave
    type(pair_statistics_type), intent(inout) :: statistic
    real(DP) :: edge
    logical :: is_turned, is_yielding
    is_yielding = gives_way(slave%overrides)
    if (slave%row > 0 .and. slave%slave_facet == 0) is_yielding = is_yielding &
      .or. contact%mortar(slave%pair)%places(slave%row)%is_merged
    if (is_yielding) statistic%n_passive = statistic%n_passive + 1
    if (is_yielding) return
    statistic%n_slaves = statistic%n_slaves + 1
    if (slave%facet == 0) return
    statistic%n_projected = statistic%n_projected + 1
    edge = contact%facets(slave%pair)%edge_length(slave%facet)
    is_turned = dot_product(slave_normal, slave%normal) > MIN_SAME_DIRECTION_COSINE
    if (abs(slave%gap) <= MAX_COMPARED_GAP * edge .and. norm2(slave_normal) > 0.5_DP) then
      statistic%n_near = statistic%n_near + 1
      if (is_turned) statistic%n_same_direction = statistic%n_same_direction + 1
    end if
    if (is_turned) statistic%n_facing_away = statistic%n_facing_away + 1
    if (is_turned) return
    if (is_closed(contact, slave)) statistic%n_closed = statistic%n_closed + 1
    statistic%least_gap = min(statistic%least_gap, slave%gap)
    statistic%largest_gap = max(statistic%largest_gap, slave%gap)
    if (-slave%gap > statistic%depth * edge) then
      statistic%depth = -slave%gap / edge
      statistic%deepest = s
    end if
  end subroutine count_slave


  !> Whether a slave node touches its master at the start.
  pure logical function is_closed(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    is_closed = slave%status /= STATUS_OPEN
    if (slave%facet > 0) is_closed = is_closed .or. slave%gap <= TOL_INITIAL_CONTACT * contact%edge(slave%pair)
  end function is_closed


  !> Slave nodes without projection: normal where some overhang, an error where all do.
  subroutine check_projection(model, contact, p, statistic, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: p                       !< pair
    type(pair_statistics_type), intent(in) :: statistic
    type(diagnostic_list_type), intent(inout) :: report
    character(:), allocatable :: none
    if (statistic%n_projected == 0 .and. statistic%n_passive > 0) return
    if (model%pairs(p)%is_general .or. is_self_contact(model%pairs(p))) return   ! its faces may come together later, or never
    if (statistic%n_slaves == 0 .and. .not. model%pairs(p)%has_point_contact) then
      call report_error(report, pair_name(model, p) // ' has no slave node. Give its slave surface faces or nodes.')
    else if (statistic%n_projected == 0) then
      none = 'None of the ' // plural(statistic%n_slaves, 'slave node') // ' of ' // pair_name(model, p) // &
        ' projects on the master at the start'
      if (statistic%n_slaves == 0) none = 'No slave face of ' // pair_name(model, p) // ' faces the master at the start'
      if (can_close_later(model, contact, p)) then
        call report_warning(report, none // '; the loads may bring the surfaces together later. ' // &
          'If the master lies between nodes of the slave, swap them: the slave is the finer or smaller surface.')
      else
        call report_error(report, none // ': the surfaces do not face each other, or are farther apart than ' // &
          to_text(SEARCH_RADIUS_RATIO * contact%edge(p)) // ' (three edges of the master). Check the faces of both surfaces and ' &
          // &
          'the position of the bodies, or move them together.')
      end if
    else if (statistic%n_projected < statistic%n_slaves) then
      call report_warning(report, to_text(statistic%n_slaves - statistic%n_projected) // ' of the ' // &
        plural(statistic%n_slaves, 'slave node') // ' of ' // pair_name(model, p) // verb(statistic%n_slaves - &
        statistic%n_projected, ' does', ' do') // ' not project on the master at the start; this is normal where they overhang.')
    end if
  end subroutine check_projection


  !> Finds slave and master surfaces with normals in the same direction.
  subroutine check_direction(model, p, statistic, report)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    type(pair_statistics_type), intent(in) :: statistic
    type(diagnostic_list_type), intent(inout) :: report
    character(:), allocatable :: where
    if (model%pairs(p)%is_general .or. is_self_contact(model%pairs(p))) return   ! its surface has faces around the near ones
    if (2 * statistic%n_same_direction > statistic%n_near) then
      where = 'at ' // to_text(statistic%n_same_direction) // ' of ' // plural(statistic%n_near, 'slave node') // ' near the master'
    else if (statistic%n_facing_away > 0 .and. statistic%n_facing_away == statistic%n_projected) then
      where = 'at all ' // to_text(statistic%n_facing_away) // verb(statistic%n_facing_away, ' slave node that projects', &
        ' slave nodes that project') // ' on the master'
    else
      return
    end if
    call report_error(report, 'The surfaces of ' // pair_name(model, p) // ' face the same way ' // where // ', so they ' // &
      'cannot touch. Check the face numbers (S1 to S6) of both surfaces: each must be the outside of its body ' // &
      'towards the other.')
  end subroutine check_direction


  !> Reports the largest penetration at the start.
  subroutine check_depth(model, contact, slaves, p, statistic, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: p                       !< pair
    type(pair_statistics_type), intent(in) :: statistic
    type(diagnostic_list_type), intent(inout) :: report
    character(:), allocatable :: found
    if (statistic%depth <= MIN_REPORTED_PENETRATION .or. is_allowed(model, p, statistic%depth, contact%edge(p))) return
    associate (slave => slaves(statistic%deepest))
      found = 'In ' // pair_name(model, p) // ' slave node ' // to_text(model%mesh%node_label(slave%node)) // &
        ' lies ' // to_text(-slave%gap) // ' inside the master at the start, where an edge is ' // &
        to_text(contact%facets(p)%edge_length(slave%facet)) // ' long'
    end associate
    if (statistic%depth > MAX_PENETRATION .and. model%dialect /= DIALECT_CALCULIX) then
      call report_error(report, found // ': the surfaces are probably swapped, on the wrong side, or the bodies ' // &
        'overlap. Check the face numbers and the position of the bodies.')
    else
      call report_warning(report, found // '; this is the deepest of the pair. It is pushed out in the first ' // &
        'increment, which strains the bodies; move the nodes onto the master if that is not wanted.')
    end if
  end subroutine check_depth


  !> Slaves that face their master; on a surface around a whole body the others face away.
  pure function slaves_facing_master(contact, slaves) result(list)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, allocatable :: list(:)
    integer :: s
    list = pack([(s, s=1, size(slaves))], [(dot_product(contact%slave_normal(:, s), &
      slaves(s)%normal) <= MIN_SAME_DIRECTION_COSINE, &
      s=1, size(slaves))])
  end function slaves_facing_master


  !> Whether *CONTACT INTERFERENCE of the first step covers the penetration: an interference fit.
  pure logical function is_allowed(model, p, depth, edge)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    real(DP), intent(in) :: depth                  !< over the edge [-]
    real(DP), intent(in) :: edge                   !< [length]
    is_allowed = .false.
    if (size(model%steps) == 0 .or. depth > MAX_PENETRATION) return
    associate (step => model%steps(1))
      if (allocated(step%is_shrink_fit)) is_allowed = step%is_shrink_fit(p)
      if (allocated(step%interference)) is_allowed = is_allowed .or. abs(step%interference(p)) >= 0.5_DP * depth * edge
    end associate
  end function is_allowed


  !> Whether a pair without projection at the start can close later: finite sliding, and a force or a sufficient prescribed
  !! displacement. Under the calculix dialect always true: CalculiX accepts such decks.
  pure logical function can_close_later(model, contact, p)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: p                       !< pair
    real(DP) :: box(3, 2, 2), apart(3), largest
    integer :: i
    can_close_later = model%dialect == DIALECT_CALCULIX   ! CalculiX accepts it
    if (can_close_later .or. model%pairs(p)%is_small_sliding .or. .not. any(model%steps%is_nlgeom)) return
    associate (x => model%mesh%coordinates, slave => model%surfaces(model%pairs(p)%slave)%nodes, &
      master => model%surfaces(model%pairs(p)%master)%nodes)
      do i = 1, 3
        box(i, :, 1) = [minval(x(i, slave)), maxval(x(i, slave))]
        box(i, :, 2) = [minval(x(i, master)), maxval(x(i, master))]
      end do
    end associate
    apart = max(0.0_DP, box(:, 1, 1) - box(:, 2, 2), box(:, 1, 2) - box(:, 2, 1))
    largest = 0.0_DP
    do i = 1, size(model%steps)
      largest = max(largest, largest_prescribed(model%amplitudes, model%steps(i)%prescribed))
      if (any(model%steps(i)%prescribed%is_velocity)) largest = huge(largest)   ! where it leads is not followed
      if (size(model%steps(i)%concentrated) + size(model%steps(i)%distributed) > 0) largest = huge(largest)   ! forces: no limit
    end do
    can_close_later = largest > 0.0_DP .and. largest >= norm2(apart) - contact%reach(p)
  end function can_close_later


  !> The largest prescribed displacement of a step [length].
  pure real(DP) function largest_prescribed(amplitudes, prescribed) result(largest)
    type(amplitude_type), intent(in) :: amplitudes(:)
    type(prescribed_type), intent(in) :: prescribed(:)
    real(DP) :: factor
    integer :: i
    largest = 0.0_DP
    do i = 1, size(prescribed)
      if (prescribed(i)%is_held) cycle
      factor = 1.0_DP
      if (prescribed(i)%amplitude > 0) factor = maxval(abs(amplitudes(prescribed(i)%amplitude)%factor))
      largest = max(largest, factor * abs(prescribed(i)%end), abs(prescribed(i)%start))
    end do
  end function largest_prescribed


  !> Exact pairs may share slave faces with mid-side nodes only with pairs of the same kind: surface to surface has contact forces
  !! at mid-side nodes, node to surface constrains them to their corners.
  subroutine check_kinds(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    logical :: is_exact(size(model%pairs)), is_quadratic(size(model%pairs)), is_slave(model%mesh%n_nodes)
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: p, q, f
    is_exact = .not. is_compliant(model%interactions(model%pairs%interaction))
    is_quadratic = .false.
    do p = 1, size(model%pairs)
      associate (faces => model%surfaces(model%pairs(p)%slave))
        if (faces%is_node_based) cycle
        do f = 1, size(faces%element)
          kind = element_kind(model%mesh%kind(faces%element(f)))
          shape = facet_kind(kind%face_kind(faces%face(f)))
          is_quadratic(p) = is_quadratic(p) .or. shape%n_nodes > shape%n_corners
        end do
      end associate
    end do
    do p = 1, size(model%pairs)
      if (.not. is_exact(p) .or. .not. model%pairs(p)%is_mortar) cycle
      is_slave = .false.
      is_slave(model%surfaces(model%pairs(p)%slave)%nodes) = .true.
      do q = 1, size(model%pairs)
        if (.not. is_exact(q) .or. model%pairs(q)%is_mortar .or. .not. (is_quadratic(p) .or. is_quadratic(q))) cycle
        if (any(is_slave(model%surfaces(model%pairs(q)%slave)%nodes))) call report_error(report, pair_name(model, p) // &
          ' is surface to surface and shares slave nodes of quadratic faces with ' // pair_name(model, q) // ', which is ' // &
          'node to surface. Give both the same TYPE.')
      end do
    end do
  end subroutine check_kinds


  !> Nodes that are on both sides of a pair. (Pairs may share nodes: see amontons_shared_slave_nodes.)
  subroutine check_overlap(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    type(integer_list_type) :: common
    logical, allocatable :: is_slave(:)            ! (n_nodes)
    integer :: p, i
    allocate (is_slave(model%mesh%n_nodes))
    do p = 1, size(model%pairs)
      if (is_self_contact(model%pairs(p))) cycle
      common = integer_list_type()
      is_slave = .false.
      is_slave(model%surfaces(model%pairs(p)%slave)%nodes) = .true.
      associate (nodes => model%surfaces(model%pairs(p)%master)%nodes)
        do i = 1, size(nodes)
          if (is_slave(nodes(i))) call common%add(model%mesh%node_label(nodes(i)))
        end do
      end associate
      if (common%n == 0) cycle
      call report_error(report, capitalized(counted_noun('node', common%trimmed(), 'belongs', 'belong')) // ' to both ' // &
        'surfaces of ' // pair_name(model, p) // '. A body cannot touch itself at its own nodes: take them out ' // &
        'of one surface, or give the two bodies nodes of their own.')
    end do
  end subroutine check_overlap


  !> A step cannot give a surface that touches itself a law that is not hard.
  subroutine check_self_contact_laws(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    integer :: i, p
    do i = 1, size(model%steps)
      if (.not. allocated(model%steps(i)%interactions)) cycle
      do p = 1, size(model%pairs)
        if (.not. is_self_contact(model%pairs(p))) cycle
        if (is_compliant(model%steps(i)%interactions(model%pairs(p)%interaction))) call report_error(report, 'Step ' // &
          to_text(i) // ' changes the pressure-overclosure of ' // pair_name(model, p) // '. A surface that touches itself ' // &
          'has hard contact only.')
      end do
    end do
  end subroutine check_self_contact_laws


  !> Slave nodes with a support or an equation along the contact normal: contact cannot act on them. That is as it should be where
  !! supports hold the master, too, and at nodes that a tie bonds to it; in general contact at tied nodes altogether, because their
  !! tie's master is at their place and has the contact of both.
  subroutine check_held(model, contact, slaves, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(diagnostic_list_type), intent(inout) :: report
    type(integer_list_type), allocatable :: found(:)
    logical, allocatable :: is_free(:, :), was_reported(:), is_movable(:, :)
    integer :: i, s, p, tie_line(model%mesh%n_nodes)
    tie_line = find_tie_lines(model)
    allocate (was_reported(size(model%pairs)), source=.false.)
    do i = 1, size(model%steps)
      call find_free_unknowns(model, i, is_free)
      is_movable = movable_directions(model, i)
      if (allocated(found)) deallocate (found)
      allocate (found(size(model%pairs)))
      do s = 1, size(slaves)
        if (slaves(s)%facet == 0) cycle
        if (is_compliant(model%interactions(model%pairs(slaves(s)%pair)%interaction))) cycle
        if (.not. is_held_along(slaves(s), is_free(:, slaves(s)%node))) cycle
        if (is_bonded(model, slaves(s)%pair, tie_line(slaves(s)%node))) cycle
        if (.not. can_give_way(contact, slaves(s), is_movable)) cycle
        call found(slaves(s)%pair)%add(model%mesh%node_label(slaves(s)%node))
      end do
      do p = 1, size(found)
        if (found(p)%n == 0 .or. was_reported(p)) cycle
        was_reported(p) = .true.
        call report_warning(report, 'In step ' // to_text(i) // ' the displacement along the contact normal is held by a ' // &
          'support or an equation at ' // plural(found(p)%n, 'slave node') // ' of ' // pair_name(model, p) // ' (' // &
          label_list(found(p)%trimmed()) // '): the contact cannot push there. ' // swap_advice(model%pairs(p)) // '.')
      end do
    end do
  end subroutine check_held


  !> Whether the tie that holds a slave node bonds it to the master of its pair, or the pair is one of general contact.
  pure logical function is_bonded(model, p, line)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    integer, intent(in) :: line                    !< of the tie; 0: none
    integer :: i
    is_bonded = line > 0 .and. model%pairs(p)%is_general
    if (line == 0 .or. is_bonded) return
    is_bonded = any([(model%ties(i)%line == line .and. model%ties(i)%master == model%pairs(p)%master, i=1, size(model%ties))])
  end function is_bonded


  !> The displacements of the nodes that supports do not prescribe, by themselves or as those of their rigid body.
  function movable_directions(model, step) result(is_movable)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< of the model, from 1
    logical :: is_movable(3, model%mesh%n_nodes)
    type(rigid_bodies_type) :: bodies
    call collect_rigid_bodies(model, bodies)
    is_movable = free_unknowns(model, step) .and. .not. spread(bodies%is_driven, 1, 3)
  end function movable_directions


  !> Whether a node of the master's facet, of an analytic master one that carries it, can move along the normal.
  pure logical function can_give_way(contact, slave, is_movable) result(is_so)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave    !< with a facet
    logical, intent(in) :: is_movable(:, :)        !< (3, n_nodes) of `movable_directions`
    integer :: i
    associate (facets => contact%facets(slave%pair))
      is_so = any([(norm2(merge(slave%normal, 0.0_DP, is_movable(:, facets%nodes(i)))) >= MIN_FREE_PART, &
        i=facets%first(slave%facet), facets%first(slave%facet + 1) - 1)])
    end associate
  end function can_give_way


  !> Whether a slave node cannot move along its contact normal.
  pure logical function is_held_along(slave, is_free)
    type(slave_state_type), intent(in) :: slave
    logical, intent(in) :: is_free(3)              !< its displacement components
    is_held_along = slave%facet > 0
    if (is_held_along) is_held_along = norm2(merge(slave%normal, 0.0_DP, is_free)) < MIN_FREE_PART
  end function is_held_along


  !> The unknowns that neither a support of the step nor the first term of an equation eliminates.
  subroutine find_free_unknowns(model, step, is_free)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    logical, allocatable, intent(out) :: is_free(:, :)   !< (3, n_nodes)
    integer :: i
    is_free = free_unknowns(model, step)
    do i = 1, size(model%equations)
      is_free(model%equations(i)%dof(1), model%equations(i)%node(1)) = .false.
    end do
  end subroutine find_free_unknowns


  !> 'the contact pair SLAVE / MASTER'.
  pure function pair_name(model, p) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    character(:), allocatable :: text
    text = 'the contact pair ' // model%surfaces(model%pairs(p)%slave)%name // ' / ' // &
      model%surfaces(model%pairs(p)%master)%name
  end function pair_name


  !> The text with an upper-case first letter.
  pure function capitalized(text) result(sentence)
    character(*), intent(in) :: text
    character(:), allocatable :: sentence
    sentence = text
    if (text(1:1) >= 'a' .and. text(1:1) <= 'z') sentence(1:1) = achar(iachar(text(1:1)) - 32)
  end function capitalized

end module amontons_model_check_contact
